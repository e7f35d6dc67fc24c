// Sinew from C#: a thin layer over the C interface; sinew.h says what each call means, in which units.
//
//     using (var asset = Asset.Load("hero.sinew"))
//     using (var world = World.Create(null)) {
//       Character hero = world.AddCharacter(asset, null);
//       var play = new Play { character = hero.Handle, asset = asset.Handle, rate = 1 };
//       for (int frame = 0; frame < 180; ++frame) {
//         play.time = frame / 60.0;
//         Library.PlayClips(new[] { play });
//         world.Step(1 / 60f);
//         View model = hero.GetView(ViewKind.Model);   // model.data: a Transform for each joint, without a copy
//       }
//     }
//
// Structs are those of the C interface, blittable, with the names of its fields; Default() of settings asks the library. A
// status that is not OK is thrown as Error. Worlds and assets are destroyed by Dispose, or when nothing refers to them any more.
using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;
using System.Text;

namespace Sinew {
  /// <summary>What the library refused.</summary>
  public sealed class Error : Exception {
    public readonly Status Status;
    /// <summary>Of the joint, clip or element that the reason is about; -1: none.</summary>
    public readonly int Index;
    /// <summary>With Status.TooSmall: elements or bytes that it would have taken.</summary>
    public readonly long Needed;

    Error(Status status, string reason, int index, long needed)
        : base(Library.StatusName(status) + ": " + reason + (index < 0 ? "" : " (" + index + ")")) {
      Status = status;
      Index = index;
      Needed = needed;
    }

    internal static unsafe void Check(Status status, long needed = 0) {
      if (status == Status.Ok) return;
      throw new Error(status, Library.Text(Native.sinew_last_reason()), Native.sinew_last_index(),
                      status == Status.TooSmall ? needed : 0);
    }

    internal static byte[] Utf8(string words) {
      return words == null ? null : Encoding.UTF8.GetBytes(words + "\0");
    }

    internal static void Has(Array numbers, int count, string name) {
      if (numbers == null || numbers.Length != count) throw new ArgumentException(count + " numbers are wanted", name);
    }
  }

  public static unsafe partial class Library {
    static readonly List<Delegate> kept = new List<Delegate>();  // that the library may still call
    /// <summary>"0.2.0", of the library.</summary>
    public static string Version { get { return Text(Native.sinew_version()); } }
    public static string StatusName(Status status) { return Text(Native.sinew_status_name(status)); }
    /// <summary>Words that a struct points to.</summary>
    public static string Text(byte* utf8) {
      int length = 0;
      while (utf8 != null && utf8[length] != 0) ++length;
      var bytes = new byte[length];
      for (int n = 0; n < length; ++n) bytes[n] = utf8[n];
      return Encoding.UTF8.GetString(bytes);
    }
  }

  public sealed unsafe partial class World {
    readonly List<Delegate> kept = new List<Delegate>();  // that the library may still call
  }

  /// <summary>Memory for one jet (local motion) of each joint, at a multiple of 16 bytes as the library wants it.</summary>
  public sealed unsafe class Jets : IDisposable {
    IntPtr memory;
    public readonly int Count;

    public Jets(int count) {
      if (count < 0) throw new ArgumentOutOfRangeException("count");
      Count = count;
      memory = Marshal.AllocHGlobal(new IntPtr(count * (long)sizeof(Jet) + 16));
      for (int n = 0; n < count; ++n) Pointer[n] = default(Jet);
    }
    ~Jets() { Marshal.FreeHGlobal(memory); }
    public void Dispose() {
      Marshal.FreeHGlobal(memory);
      memory = IntPtr.Zero;
      GC.SuppressFinalize(this);
    }
    /// <summary>[Count]; null after Dispose.</summary>
    public Jet* Pointer {
      get { return memory == IntPtr.Zero ? null : (Jet*)(((long)memory + 15) & ~15L); }
    }
  }
}
