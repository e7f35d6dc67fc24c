//! SINEW_LIB_DIR: where libsinew is, unless the linker finds it by itself.
fn main() {
    println!("cargo:rerun-if-env-changed=SINEW_LIB_DIR");
    if let Ok(directory) = std::env::var("SINEW_LIB_DIR") {
        println!("cargo:rustc-link-search=native={directory}");
    }
}
