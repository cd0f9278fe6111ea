# shellcheck shell=bash
# What the scripts of the tests share; they source it.
#
# All of them build with the same profile, and with one of two sets of features: none, or all whose libraries
# are here, with less optimization. The tests that need none are built as `cargo test` builds them, also where
# only the program is wanted: `cargo build` would compile it again, since it gives the dependencies fewer
# features.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
mkdir -p target
script=tests/${0##*/}
PATH=$PATH:/sbin:/usr/sbin # ldconfig, slurmctld

fail() {
    echo "$script: $*" >&2
    exit 1
}

as_root() {
    if [ "$(id -u)" = 0 ]; then "$@"; else sudo "$@"; fi
}

# What is needed of Debian, and its packages.
declare -A packages=(
    [chromium]="chromium"
    [embree]="libembree3-3"
    [hdf5]="libhdf5-dev"
    [opencl]="ocl-icd-libopencl1 pocl-opencl-icd"
    [mpi]="libopenmpi-dev openmpi-bin libclang-dev"
    [paraview]="imagemagick libqt5svg5 paraview python3-paraview python3-venv xauth xdotool xvfb"
    [poppler]="poppler-utils"
    [slurm]="slurmd slurmctld slurm-client munge"
)

# Whether it is there.
have() {
    case $1 in
    chromium) command -v chromium ;;
    embree) ldconfig -p | grep 'libembree3\.so\.3 ' ;;
    hdf5) command -v h5cc || pkg-config --exists hdf5 ;;
    opencl) ldconfig -p | grep 'libOpenCL\.so\.1 ' && ls /etc/OpenCL/vendors/pocl.icd ;;
    mpi) command -v mpirun && command -v mpicc && ls /usr/lib/llvm-*/lib/libclang*.so ;;
    # Debian's Python, whatever others are first in PATH: pvbatch and the packages go with it.
    paraview)
        command -v paraview && command -v pvbatch && command -v xvfb-run && command -v xauth &&
            command -v import && command -v xdotool && /usr/bin/python3 -c 'import ensurepip, paraview'
        ;;
    poppler) command -v pdftotext && command -v pdfinfo ;;
    slurm) command -v slurmctld && command -v slurmd && command -v munged && command -v sbatch ;;
    esac >/dev/null 2>&1
}

# Installs it where it is missing. Slurm and MUNGE come without their services, which Debian would enable and
# start: the tests run their own.
need() {
    if have "$1"; then return; fi
    command -v apt-get >/dev/null || fail "install ${packages[$1]} first"
    echo "$script: installing ${packages[$1]} ..."
    local log=target/install-$1.log
    local apt=(env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=600)
    local no_services=()
    for path in /lib/systemd/system/{slurmd,slurmctld,munge}.service /etc/init.d/{slurmd,slurmctld,munge}; do
        no_services+=(-o "DPkg::Options::=--path-exclude=$path")
    done
    # shellcheck disable=SC2086
    # Others may install at the same time.
    { flock 9 && as_root "${apt[@]}" update &&
        as_root "${apt[@]}" "${no_services[@]}" install -y --no-install-recommends ${packages[$1]}; } \
        9>target/install.lock >"$log" 2>&1 ||
        { cat "$log" >&2; fail "could not install ${packages[$1]}"; }
    have "$1" || fail "${packages[$1]} are installed, but something of them does not work"
}

# A Python in target/$1 with these packages of PyPI, which it installs where the check fails.
venv() {
    local python=$PWD/target/$1/bin/python check=$2
    shift 2
    if ! "$python" -c "$check" >/dev/null 2>&1; then
        echo "$script: installing $* from PyPI ..." >&2
        /usr/bin/python3 -m venv --clear "${python%/bin/python}" >&2
        "$python" -m pip install --quiet "$@" >&2 || fail "could not install $*"
    fi
    echo "$python"
}

# All features whose libraries are here.
features() {
    local all=profile
    for feature in hdf5 mpi; do
        if have $feature; then all+=,$feature; fi
    done
    echo $all
}

# Runs a command of cargo with all features. What they change is compiled for few tests only: faster than for the others.
with_features() {
    local profile=(--config profile.dev.package.raycost-render.opt-level=1)
    for crate in raycost raycost-{vtk,import,scene,output,tools}; do
        profile+=(--config "profile.dev.package.$crate.opt-level=0")
    done
    cargo "$1" --quiet --locked "${profile[@]}" --features "$(features)" "${@:2}"
}

# Builds the program, and says where it is.
program() {
    cargo test --quiet --locked --no-run --test commands >&2
    echo "$PWD/target/debug/raycost"
}

# Says how many checks have passed, for the table of tests/all.
passed() {
    echo "$script: $1 passed; 0 failed${2+; $2}"
}

# A Python with PyPI's vtk and pyvista.
vtk_python() {
    local versions=(9.7.2 0.49.1)
    venv vtk "import pyvista, vtkmodules
assert (vtkmodules.__version__, pyvista.__version__) == ('${versions[0]}', '${versions[1]}')" \
        "vtk==${versions[0]}" "pyvista==${versions[1]}"
}
