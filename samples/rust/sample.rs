//! Sinew from Rust: a walker is hit by a ball, and pushed a second later: the run of ../c/main.c, to the bit.
//! Usage: sample ASSET.sinew [FRAMES].
use sinew::{Asset, Play, PropSettings, Role, Transform, World};

/// FNV-1a over rotation and translation of every joint.
fn add_pose(hash: u64, model: &[Transform]) -> u64 {
    let numbers = model.iter().flat_map(|joint| joint.rotation.iter().chain(&joint.translation));
    let bytes = numbers.flat_map(|x| x.to_ne_bytes());
    bytes.fold(hash, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x100000001b3))
}

fn run(path: &str, frames: i32) -> sinew::Result<()> {
    let asset = Asset::load(path)?;
    let chest = asset.find_role(Role::CHEST)?;
    let world = World::create(None)?;
    let hero = world.add_character(&asset, None)?;
    let mut ball = PropSettings::default();
    ball.mass = 4.0;
    ball.velocity = [1.2, -6.0, 2.0];
    ball.pose.translation = [0.0, 3.0, 1.5];
    world.add_prop(Some(&ball))?;

    let mut play = Play { character: hero.handle(), asset: asset.handle(), rate: 1.0, ..Default::default() };
    let mut hash = 0xcbf29ce484222325;
    for frame in 0..frames {
        play.time = f64::from(frame) / 60.0;
        sinew::play_clips(&[play])?;
        if frame == 0 {
            hero.reset()?;
        }
        if frame == 60 {
            let at = hero.model()?[chest as usize].translation;
            hero.apply_impulse(chest, at.map(f64::from), [0.0, 90.0, 0.0])?;
        }
        world.step(1.0 / 60.0)?;
        hash = add_pose(hash, &hero.model()?);
    }
    let report = hero.report()?;
    let at_rest = if report.on_animation != 0 { "on" } else { "off" };
    println!("{} of {} degrees of freedom unknown at the end, {at_rest} the animation", report.unknown_dofs, report.dofs);
    println!("pose hash {hash:016x}");
    Ok(())
}

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    if arguments.len() < 2 {
        eprintln!("usage: sample ASSET.sinew [FRAMES]");
        std::process::exit(2);
    }
    let frames = arguments.get(2).map_or(Ok(180), |words| words.parse());
    let frames = frames.unwrap_or_else(|_| {
        eprintln!("rust: {}: not a number of frames", arguments[2]);
        std::process::exit(2);
    });
    if let Err(error) = run(&arguments[1], frames) {
        eprintln!("rust: {}: {error}", arguments[1]);
        std::process::exit(1);
    }
}
