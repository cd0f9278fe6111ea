//! raycost
fn main() {}
