// The page: Sinew as WebAssembly moves the bones of a glTF character that three.js draws.
import * as THREE from 'three';
import { GLTFLoader } from './three/loaders/GLTFLoader.js';
import createSinew from './sinew.js';

const kMostFrame = 0.1;  // s; a page that was in the background does not catch up
const kTested = new URLSearchParams(location.search).has('test');
const element = (id) => document.getElementById(id);

function fail(why) {
  element('fault').textContent = why;
  element('fault').hidden = false;
  throw new Error(why);
}

async function bytes(url) {
  const response = await fetch(url);
  if (!response.ok) fail(`${url}: ${response.status} ${response.statusText}`);
  return new Uint8Array(await response.arrayBuffer());
}

/** The functions of page.c; what they say is wrong is thrown. */
class Character {
  constructor(module, asset) {
    this.module = module;
    const at = module._malloc(asset.length);
    module.HEAPU8.set(asset, at);
    this.check(module._page_open(at, asset.length));
    module._free(at);
    this.names = Array.from({ length: module._page_joints() }, (_, j) => module.UTF8ToString(module._page_joint_name(j)));
  }
  check(reason) {
    if (reason) fail(this.module.UTF8ToString(reason));
  }
  play(clip) {
    const name = this.module.allocateUTF8(clip);
    const reason = this.module._page_play(name);
    this.module._free(name);
    this.check(reason);
  }
  step(h) {
    this.check(this.module._page_step(h));
  }
  /** Pose of joint `j`, or of a ball: world, z up, m. */
  pose(address, into) {
    const f = this.module.HEAPF32, k = address >> 2;
    return into.compose(new THREE.Vector3(f[k + 4], f[k + 5], f[k + 6]), new THREE.Quaternion(f[k], f[k + 1], f[k + 2], f[k + 3]),
                        new THREE.Vector3(1, 1, 1));
  }
  joint(j, into) {
    return this.pose(this.module._page_models() + 32 * j, into);
  }
  ball(b, into) {
    return this.pose(this.module._page_ball(b), into);
  }
}

// Sinew's z is up, three.js's y is.
const kUpright = new THREE.Matrix4().makeRotationX(-Math.PI / 2);

/** The bones of a scene, each driven by the joint of its name. */
class Bones {
  constructor(character, model) {
    this.character = character;
    model.updateMatrixWorld(true);
    this.driven = [];
    character.names.forEach((name, joint) => {
      const bone = model.getObjectByName(THREE.PropertyBinding.sanitizeNodeName(name));
      if (!bone) return;
      // A joint's frame is turned against its bone's, once and for all.
      const rest = character.joint(joint, new THREE.Matrix4()).premultiply(kUpright);
      this.driven.push({ bone, joint, offset: rest.invert().multiply(bone.matrixWorld) });
    });
    if (this.driven.length === 0) fail('no bone of the model has the name of a joint');
    for (const { bone } of this.driven) bone.updateMatrixWorld = () => {};  // what follow() wrote stays
    // Skinned vertices come out in the world: the mesh itself stays where it was bound.
    model.traverse((node) => { if (node.isSkinnedMesh) node.frustumCulled = false; });
  }
  follow() {
    for (const { bone, joint, offset } of this.driven)
      this.character.joint(joint, bone.matrixWorld).premultiply(kUpright).multiply(offset);
  }
}

class Stage {
  constructor(canvas) {
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, preserveDrawingBuffer: kTested });
    this.renderer.shadowMap.enabled = true;
    this.scene = new THREE.Scene();
    this.scene.background = new THREE.Color(0x10151c);
    this.scene.fog = new THREE.Fog(0x10151c, 8, 30);
    this.camera = new THREE.PerspectiveCamera(40, 1, 0.05, 100);
    this.scene.add(new THREE.HemisphereLight(0xe4eeff, 0x6a5f52, 2.6));
    this.sun = new THREE.DirectionalLight(0xfff4e2, 3);
    this.sun.castShadow = true;
    this.sun.shadow.mapSize.set(1024, 1024);
    for (const side of ['left', 'bottom']) this.sun.shadow.camera[side] = -3;
    for (const side of ['right', 'top']) this.sun.shadow.camera[side] = 3;
    this.sun.shadow.camera.far = 20;
    this.sun.shadow.normalBias = 0.02;  // m
    this.scene.add(this.sun, this.sun.target);
    const floor = new THREE.Mesh(new THREE.PlaneGeometry(400, 400), new THREE.MeshStandardMaterial({ color: 0x46515d }));
    floor.rotation.x = -Math.PI / 2;
    floor.receiveShadow = true;
    const grid = new THREE.GridHelper(400, 400, 0x222a33, 0x323b45);
    grid.position.y = 0.002;
    this.scene.add(floor, grid);
    addEventListener('resize', () => this.resize());
    this.resize();
  }
  resize() {
    this.renderer.setSize(innerWidth, innerHeight, false);
    this.camera.aspect = innerWidth / innerHeight;
    this.camera.updateProjectionMatrix();
  }
  /** Beside what walks there, at `at`. */
  draw(at) {
    this.camera.position.set(at.x + 2.1, 1.5, at.z + 2.8);
    this.camera.lookAt(at.x - 0.4, 0.95, at.z);
    this.sun.position.set(at.x + 2, 5, at.z + 1.5);
    this.sun.target.position.set(at.x, 0, at.z);
    this.renderer.render(this.scene, this.camera);
  }
}

/** Unknown degrees of freedom (bars) and microseconds of a step (line) over the last frames. */
class Graph {
  constructor(canvas) {
    this.context = canvas.getContext('2d');
    this.samples = [];
  }
  add(unknowns, dofs, microseconds) {
    this.samples.push({ unknowns: unknowns / dofs, microseconds });
    if (this.samples.length > 280) this.samples.shift();
    const { width, height } = this.context.canvas;
    this.context.clearRect(0, 0, width, height);
    this.context.fillStyle = '#d0643c';
    this.samples.forEach((s, i) => this.context.fillRect(2 * i, height * (1 - s.unknowns), 2, height * s.unknowns));
    this.context.strokeStyle = '#8fb7e0';
    this.context.beginPath();
    this.samples.forEach((s, i) => this.context.lineTo(2 * i, height * (1 - Math.min(s.microseconds / 2000, 1))));
    this.context.stroke();
  }
}

async function start() {
  const [module, asset, gltf] = await Promise.all(
    [createSinew(), bytes('mannequin.sinew'), new GLTFLoader().loadAsync('mannequin.glb')]);
  const character = new Character(module, asset);
  const stage = new Stage(element('view'));
  const bones = new Bones(character, gltf.scene);
  gltf.scene.traverse((node) => {
    node.castShadow = node.receiveShadow = node.isMesh;
    if (node.name.startsWith('UCX_')) node.visible = false;  // what bodies are fitted to
  });
  stage.scene.add(gltf.scene);
  const ball = new THREE.SphereGeometry(module._page_ball_radius(), 24, 16);
  const balls = Array.from({ length: module._page_balls() }, () => {
    const mesh = new THREE.Mesh(ball, new THREE.MeshStandardMaterial({ color: 0xd0a53c }));
    mesh.castShadow = true;
    mesh.matrixAutoUpdate = mesh.visible = false;
    stage.scene.add(mesh);
    return mesh;
  });
  character.play('walk');
  return { module, character, stage, bones, balls, thrown: 0, graph: new Graph(element('graph')), frames: 0, left: 0,
           at: new THREE.Vector3(), velocity: new THREE.Vector3() };
}

/** From the eye, which goes with the character, through a point of the picture, −1 to 1 each way. */
function throwBall(game, x, y, speed) {
  const ray = new THREE.Raycaster();
  ray.setFromCamera(new THREE.Vector2(x, y), game.stage.camera);
  const from = ray.ray.origin.clone().addScaledVector(ray.ray.direction, 1);
  const far = game.stage.camera.position.distanceTo(game.at) - 1;
  // Up by what it falls on the way.
  const velocity = ray.ray.direction.clone().multiplyScalar(speed).add(new THREE.Vector3(0, 9.81 * far / speed / 2, 0));
  velocity.add(game.velocity);
  game.module._page_throw(from.x, -from.z, from.y, velocity.x, -velocity.z, velocity.y);
  game.balls[game.thrown % game.balls.length].visible = true;
  game.thrown += 1;
}

/** Of the root, as three.js has it. */
function position(game) {
  return new THREE.Vector3().setFromMatrixPosition(game.character.joint(0, new THREE.Matrix4()).premultiply(kUpright));
}

function drawFrame(game) {
  game.bones.follow();
  game.balls.forEach((mesh, b) => {
    if (!mesh.visible) return;
    game.character.ball(b, mesh.matrix).premultiply(kUpright);
    mesh.matrixWorldNeedsUpdate = true;
  });
  game.at = position(game);
  game.stage.draw(game.at);
  game.frames += 1;
}

function stepFor(game, seconds) {
  const h = 1 / element('step').valueAsNumber;
  game.left = Math.min(game.left + seconds, kMostFrame);
  for (; game.left >= h; game.left -= h) {
    const from = position(game), before = performance.now();
    game.character.step(h);
    const microseconds = 1000 * (performance.now() - before);
    game.velocity = position(game).sub(from).divideScalar(h).setY(0);
    game.graph.add(game.module._page_unknowns(), game.module._page_dofs(), microseconds);
    element('figures').textContent =
      `${game.module._page_unknowns()} of ${game.module._page_dofs()} degrees of freedom unknown, ${microseconds.toFixed(0)} µs`;
  }
}

function bindPanel(game) {
  const show = (id, unit) => {
    const say = () => { element(`${id}-value`).textContent = unit(element(id).valueAsNumber); };
    element(id).addEventListener('input', say);
    say();
  };
  show('speed', (v) => `${v} m/s`);
  show('strength', (v) => `${v.toFixed(1)} of its own`);
  show('step', (v) => `1/${v} s`);
  element('strength').addEventListener('input', () => game.module._page_strength(element('strength').valueAsNumber));
  element('clip').addEventListener('change', () => game.character.play(element('clip').value));
  element('knock-out').addEventListener('click', () => game.module._page_knock_out(1.5));
  element('view').addEventListener('pointerdown', (event) => throwBall(
    game, 2 * event.clientX / innerWidth - 1, 1 - 2 * event.clientY / innerHeight, element('speed').valueAsNumber));
}

const game = await start();
bindPanel(game);
drawFrame(game);
if (kTested) {
  const { test } = await import('./test.js');
  await test({ game, stepFor, drawFrame, throwBall, element });
} else {
  let last = performance.now();
  game.stage.renderer.setAnimationLoop(() => {
    const now = performance.now();
    stepFor(game, (now - last) / 1000);
    last = now;
    drawFrame(game);
  });
}
