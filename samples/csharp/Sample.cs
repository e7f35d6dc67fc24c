// Sinew from C#: a walker is hit by a ball, and pushed a second later: the run of ../c/main.c, to the bit.
// Usage: sample.exe ASSET.sinew [FRAMES].
using System;
using Sinew;

static unsafe class Sample {
  // FNV-1a over rotation and translation of every joint.
  static ulong AddPose(ulong hash, View model) {
    for (int joint = 0; joint < model.count; ++joint) {
      byte* bytes = (byte*)model.data + joint * model.stride;
      for (int k = 0; k < 7 * sizeof(float); ++k) hash = unchecked((hash ^ bytes[k]) * 0x100000001b3);
    }
    return hash;
  }

  static PropSettings Ball() {
    PropSettings ball = PropSettings.Default();
    ball.mass = 4;
    ball.pose.translation[1] = 3;
    ball.pose.translation[2] = 1.5;
    ball.velocity[0] = 1.2;  // as the walker
    ball.velocity[1] = -6;
    ball.velocity[2] = 2;
    return ball;
  }

  static void Run(string path, int frames) {
    using (Asset asset = Asset.Load(path))
    using (World world = World.Create(null)) {
      int chest = asset.FindRole(Role.Chest);
      Character hero = world.AddCharacter(asset, null);
      world.AddProp(Ball());
      var plays = new[] { new Play { character = hero.Handle, asset = asset.Handle, rate = 1 } };
      ulong hash = 0xcbf29ce484222325;
      for (int frame = 0; frame < frames; ++frame) {
        plays[0].time = frame / 60.0;
        Library.PlayClips(plays);
        if (frame == 0) hero.Reset();
        if (frame == 60) {
          Transform* at = (Transform*)hero.GetView(ViewKind.Model).data + chest;
          hero.ApplyImpulse(chest, new double[] { at->translation[0], at->translation[1], at->translation[2] },
                            new double[] { 0, 90, 0 });
        }
        world.Step(1 / 60f);
        hash = AddPose(hash, hero.GetView(ViewKind.Model));
      }
      CharacterReport report = hero.GetReport();
      Console.WriteLine("{0} of {1} degrees of freedom unknown at the end, {2} the animation", report.unknown_dofs,
                        report.dofs, report.on_animation != 0 ? "on" : "off");
      Console.WriteLine("pose hash {0:x16}", hash);
    }
  }

  static int Main(string[] arguments) {
    if (arguments.Length < 1) {
      Console.Error.WriteLine("usage: sample.exe ASSET.sinew [FRAMES]");
      return 2;
    }
    try {
      Run(arguments[0], arguments.Length > 1 ? int.Parse(arguments[1]) : 180);
    } catch (Error error) {
      Console.Error.WriteLine("csharp: {0}: {1}", arguments[0], error.Message);
      return 1;
    }
    return 0;
  }
}
