//! Detects that a launcher has started several processes of this program.

use std::env;

/// Variables in which launchers store the number of processes: Open MPI's, then the variable of
/// Hydra's and Slurm's process management.
const SIZES: [&str; 2] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"];

/// Returns the number of processes that `mpirun`, or another launcher of MPI, has started together,
/// which may be one, or `None` if this process was started otherwise.
pub fn n_launched() -> Option<u32> {
    let number = |name: &str| env::var(name).ok()?.parse::<u32>().ok();
    let of_launcher = SIZES.iter().find_map(|name| number(name));
    // `srun --mpi=pmix` does not set the size of the world.
    let of_step = || number("PMIX_RANK").and_then(|_| number("SLURM_STEP_NUM_TASKS"));
    of_launcher.or_else(of_step)
}
