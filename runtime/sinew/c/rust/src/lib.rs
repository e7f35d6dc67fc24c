//! Sinew from Rust: a thin layer over the C interface; sinew.h says what each call means, in which units.
//!
//! ```no_run
//! # fn main() -> sinew::Result<()> {
//! let asset = sinew::Asset::load("hero.sinew")?;
//! let world = sinew::World::create(None)?;
//! let hero = world.add_character(&asset, None)?;
//! for frame in 0..180 {
//!     let play = sinew::Play {
//!         character: hero.handle(), asset: asset.handle(), time: f64::from(frame) / 60.0, rate: 1.0, ..Default::default()
//!     };
//!     sinew::play_clips(&[play])?;
//!     world.step(1.0 / 60.0)?;
//!     println!("{:?}", hero.model()?[0].translation);
//! }
//! # Ok(())
//! # }
//! ```
//!
//! Settings are structs with the names of the C fields; `Default` asks the library. Pointers and functions in them are set by
//! methods that are `unsafe`, all else is safe: numbers, lengths and handles are checked. Worlds and assets are destroyed
//! when they are dropped. Nothing of the crate leaves the thread that made it, which keeps the world's memory from changing
//! while it is copied; other threads have worlds of their own.
#![warn(unsafe_op_in_unsafe_fn)]
use std::ffi::{CStr, CString};
use std::fmt;
use std::marker::PhantomData;

mod api;
pub mod sys;
pub use api::*;

type OneThread = PhantomData<*const ()>;

/// What the library refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Error {
    pub status: Status,
    /// One clause.
    pub reason: String,
    /// Of the joint, clip or element that the reason is about; -1: none.
    pub index: i32,
    /// With `Status::TOO_SMALL`: elements or bytes that it would have taken. Else 0.
    pub needed: usize,
}

pub type Result<T> = std::result::Result<T, Error>;

impl fmt::Display for Error {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}: {}", status_name(self.status), self.reason)?;
        if self.index >= 0 {
            write!(out, " ({})", self.index)?;
        }
        Ok(())
    }
}

impl std::error::Error for Error {}

/// "0.2.0", of the library.
pub fn version() -> &'static str {
    // SAFETY: a constant of the library.
    unsafe { CStr::from_ptr(sys::sinew_version()) }.to_str().unwrap_or("")
}

/// "SINEW_NOT_FINITE"; "unknown status" of another number.
pub fn status_name(status: Status) -> &'static str {
    // SAFETY: a constant of the library.
    unsafe { CStr::from_ptr(sys::sinew_status_name(status)) }.to_str().unwrap_or("")
}

fn check(status: Status, needed: usize) -> Result<()> {
    if status == Status::OK {
        return Ok(());
    }
    // SAFETY: constants of the library.
    let (reason, index) = unsafe { (CStr::from_ptr(sys::sinew_last_reason()), sys::sinew_last_index()) };
    let needed = if status == Status::TOO_SMALL { needed } else { 0 };
    Err(Error { status, reason: reason.to_string_lossy().into_owned(), index, needed })
}

fn refused(reason: &str) -> Error {
    Error { status: Status::INVALID_ARGUMENT, reason: reason.to_owned(), index: -1, needed: 0 }
}

fn text(words: &str) -> Result<CString> {
    CString::new(words).map_err(|_| refused("a string with a NUL in it"))
}

fn length(elements: usize) -> Result<i32> {
    i32::try_from(elements).map_err(|_| refused("more elements than 32 bits can count"))
}

/// # Safety
/// The view shows elements of `T`, and its world lives.
unsafe fn copied<T: Copy>(view: &View) -> Vec<T> {
    if view.count == 0 {
        return Vec::new();
    }
    // SAFETY: the caller's promise; nothing of the world runs meanwhile, as its thread is here.
    unsafe { std::slice::from_raw_parts(view.data().cast::<T>(), view.count as usize) }.to_vec()
}

/// What `save` writes, with the memory that it takes.
fn with_room(save: impl Fn(&mut [u8]) -> Result<usize>) -> Result<Vec<u8>> {
    let most = match save(&mut []) {
        Err(error) if error.status == Status::TOO_SMALL => error.needed,
        other => other?,
    };
    let mut bytes = vec![0; most];
    let size = save(&mut bytes)?;
    bytes.truncate(size);
    Ok(bytes)
}

impl Character {
    /// Copies: joint to world, by joint.
    pub fn model(&self) -> Result<Vec<Transform>> {
        // SAFETY: transforms, as the kind of view says.
        self.view(ViewKind::MODEL).map(|view| unsafe { copied(&view) })
    }

    /// Copies: joint to parent, by joint.
    pub fn local(&self) -> Result<Vec<Transform>> {
        // SAFETY: transforms, as the kind of view says.
        self.view(ViewKind::LOCAL).map(|view| unsafe { copied(&view) })
    }

    /// Copies: torque / limit, by degree of freedom.
    pub fn loads(&self) -> Result<Vec<f32>> {
        // SAFETY: floats, as the kind of view says.
        self.view(ViewKind::LOAD).map(|view| unsafe { copied(&view) })
    }

    /// Copies all that its behaviour remembers, for `restore_behaviour`.
    pub fn behaviour_snapshot(&self) -> Result<Vec<u8>> {
        with_room(|bytes| self.save_behaviour(bytes))
    }

    /// Copies all that its graph remembers, for `restore_graph`.
    pub fn graph_snapshot(&self) -> Result<Vec<u8>> {
        with_room(|bytes| self.save_graph(bytes))
    }
}

impl World {
    /// Copies the snapshot, with the memory that it takes.
    pub fn snapshot(&self, part: SnapshotPart) -> Result<Vec<u8>> {
        with_room(|bytes| self.save(part, bytes))
    }
}
