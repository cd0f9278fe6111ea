//! Detects that a launcher has started several processes of this program.

use std::env;

/// Where launchers put the number of processes: Open MPI's, then those with Hydra's or
/// Slurm's process management.
const SIZES: [&str; 2] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"];

/// The number of processes that `mpirun`, or another launcher of MPI, has started
/// together, which may be one; `None` if nothing has started this one so.
pub fn n_launched() -> Option<u32> {
    let number = |name: &str| env::var(name).ok()?.parse::<u32>().ok();
    let of_launcher = SIZES.iter().find_map(|name| number(name));
    // `srun --mpi=pmix` gives the size of no world.
    let of_step = || number("PMIX_RANK").and_then(|_| number("SLURM_STEP_NUM_TASKS"));
    of_launcher.or_else(of_step)
}
