// What the page does in its test (`?test`): two seconds of frames with a ball and a knock-out, and the story of
// samples/c/main.c, whose poses have a hash, before and after the hit. The result is the page's title.
import createStory from './story.js';

/** Of so many frames. */
async function storyHash(frames) {
  let hash = 'none';
  const asset = new Uint8Array(await (await fetch('mannequin.sinew')).arrayBuffer());
  await createStory({
    arguments: ['mannequin.sinew', String(frames)],
    preRun: [(module) => module.FS.writeFile('mannequin.sinew', asset)],
    print: (line) => { hash = line.startsWith('pose hash ') ? line.slice(10) : hash; },
  });
  return hash;
}

/** Colours that the last picture has: an empty one has one. */
function colours(renderer) {
  const gl = renderer.getContext(), { width, height } = renderer.domElement;
  const pixels = new Uint8Array(4 * width * height);
  gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  return new Set(new Uint32Array(pixels.buffer)).size;
}

export async function test({ game, stepFor, drawFrame, throwBall, element }) {
  let most = 0, picture = '';
  for (let frame = 0; frame < 120; ++frame) {
    if (frame === 30) {
      const chest = game.at.clone().setY(1.25).project(game.stage.camera);
      throwBall(game, chest.x, chest.y, 12);
    }
    if (frame === 90) element('knock-out').click();
    stepFor(game, 1 / 60 + 1e-9);
    most = Math.max(most, frame < 90 ? game.module._page_unknowns() : 0);
    drawFrame(game);
    if (frame === 50) picture = element('view').toDataURL('image/jpeg', 0.9);
  }
  const result = { frames: game.frames, colours: colours(game.stage.renderer), unknowns: most,
                   height: game.at.y, played: await storyHash(60), hit: await storyHash(180), picture };
  document.title = `done ${JSON.stringify(result)}`;
}
