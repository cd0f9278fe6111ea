//! Detects that a launcher has started several processes of this program.

use std::env;
use std::str::FromStr;

/// Variables in which launchers store the number of processes: Open MPI's, then the variable of
/// Hydra's and Slurm's process management.
const SIZES: [&str; 2] = ["OMPI_COMM_WORLD_SIZE", "PMI_SIZE"];

/// Variables in which launchers number the processes of a machine: Open MPI's, Hydra's and Slurm's.
const LOCAL_RANKS: [&str; 3] = [
    "OMPI_COMM_WORLD_LOCAL_RANK",
    "MPI_LOCALRANKID",
    "SLURM_LOCALID",
];

/// Returns the number of this process among those that a launcher has started on this machine, from
/// 0; 0 if it was started otherwise.
pub fn local_rank() -> usize {
    LOCAL_RANKS.into_iter().find_map(number).unwrap_or(0)
}

/// Returns the number of processes that `mpirun`, or another launcher of MPI, has started together,
/// which may be one, or `None` if this process was started otherwise.
pub fn n_launched() -> Option<u32> {
    let of_launcher = SIZES.into_iter().find_map(number);
    // `srun --mpi=pmix` does not set the size of the world.
    let of_step = || number::<u32>("PMIX_RANK").and_then(|_| number("SLURM_STEP_NUM_TASKS"));
    of_launcher.or_else(of_step)
}

/// Returns the number in an environment variable.
fn number<N: FromStr>(name: &str) -> Option<N> {
    env::var(name).ok()?.parse().ok()
}
