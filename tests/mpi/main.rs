//! `mpirun raycost render`: with the feature `mpi` the ranks render each picture together; without,
//! they are refused.
#![cfg(unix)]

#[path = "../common/mod.rs"]
mod common;

#[cfg(feature = "mpi")]
mod failures;
#[cfg(feature = "mpi")]
mod frames;
#[cfg(feature = "mpi")]
mod files;
#[cfg(feature = "mpi")]
mod job;
#[cfg(feature = "mpi")]
mod pictures;
#[cfg(feature = "mpi")]
mod studies;

#[cfg(not(feature = "mpi"))]
#[test]
fn without_mpi_several_processes_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let launched = |variables: &[(&str, &str)]| {
        let mut command = common::raycost();
        command.arg("render");
        command.arg(common::in_repository("configs/seed_sphere.yaml"));
        command.args(["--width=8", "--height=8", "--quiet", "--out=out"]);
        command.envs(variables.iter().copied());
        command.current_dir(folder.path()).output().unwrap()
    };
    for variables in [
        &[("OMPI_COMM_WORLD_SIZE", "4"), ("PMIX_RANK", "0")][..],
        &[("PMI_SIZE", "2")],
        &[("PMIX_RANK", "1"), ("SLURM_STEP_NUM_TASKS", "3")],
    ] {
        let output = launched(variables);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains("built without MPI"), "{message}");
        assert!(message.contains("--features mpi"), "{message}");
        assert!(!folder.path().join("out").exists());
    }
    // The only process of a launch is the only rank, and one of a job is none.
    for (variables, n) in [
        (&[("OMPI_COMM_WORLD_SIZE", "1")][..], Some(1)),
        (
            &[("PMIX_RANK", "0"), ("SLURM_STEP_NUM_TASKS", "1")],
            Some(1),
        ),
        (&[("SLURM_STEP_NUM_TASKS", "8")], None),
    ] {
        common::assert_success(&launched(variables));
        let summary = common::same_output::summary(&folder.path().join("out"));
        let ranks = &summary["ranks"];
        assert_eq!(ranks["n"].as_u64(), n);
        if n.is_some() {
            assert_eq!(ranks["load_imbalance"], 0.0);
            assert_eq!(ranks["of_rank"][0]["n_tiles"], 1);
        }
    }
}
