//! `bvh.vtu`: the boxes of the hierarchy and the cost of each.

use std::io::{self, Seek, Write};

use glam::Vec3;
use vtkio::model::CellType;

use super::file::{FileContent, OutputFile};
use super::points::points;
use render::attribution::{Hierarchy, Visits};
use scene::config::{BvhLimits, CostMode, OptionalOutput};
use tracer::accel::BvhNode;
use tracer::cost::Metric;
use vtk::appended;
use vtk::array::{Array, Entry, separate_cells};
use vtk::data_set::{CellMesh, DataSet};
use vtk::encoding::Encoding;
use world::geometry::RenderSpace;
use world::scene::Instances;

/// The file.
pub(super) const FILE: OutputFile = OutputFile {
    name: "bvh.vtu",
    is_wanted: |request| request.has(OptionalOutput::Bvh),
    content: FileContent::Written(|job, out| {
        let rendering = job.rendering;
        let hierarchy = rendering.attribution.and_then(|of| of.hierarchy.as_ref());
        let (limits, cost) = (rendering.config.output.bvh, rendering.film.cost);
        hierarchy.map_or(Ok(()), |hierarchy| {
            let instances = rendering.scene.instances.as_ref();
            let space = rendering.scene.space;
            write(
                hierarchy,
                instances,
                space,
                limits,
                cost,
                job.encoding(),
                out,
            )
        })
    }),
};

/// A box that is shown.
struct Shown<'a> {
    node: &'a BvhNode,
    visits: &'a Visits,
    cost: f32,
}

/// Writes the nodes and leaves within the limits as an UnstructuredGrid of one VTK_VOXEL each,
/// ancestors before descendants; times only if `cost` includes them.
///
/// Nodes of an instanced mesh are drawn at its first instance, as a VTK_HEXAHEDRON each, since they
/// may be rotated there.
pub fn write(
    hierarchy: &Hierarchy,
    instances: Option<&Instances>,
    space: RenderSpace,
    limits: BvhLimits,
    cost: CostMode,
    encoding: impl Into<Encoding>,
    out: &mut (impl Write + Seek),
) -> io::Result<()> {
    let shown = choose_nodes(hierarchy, limits);
    let n = shown.len();
    let [connectivity, offsets] = separate_cells(8, n);
    let boxes = CellMesh {
        n_points: 8 * n,
        n_cells: n,
        point_data: Vec::new(),
        cell_data: cell_data(&shown, instances.is_some(), cost),
        points: points(&space, 8 * n, || {
            shown.iter().flat_map(|shown| corners(shown, instances))
        }),
        cells: vec![connectivity, offsets, types(&shown)],
    };
    appended::write(&DataSet::Grid(boxes), encoding.into(), out)
}

fn choose_nodes(hierarchy: &Hierarchy, limits: BvhLimits) -> Vec<Shown<'_>> {
    let nodes = hierarchy.within(limits).into_iter();
    nodes
        .map(|(node, visits, cost)| Shown { node, visits, cost })
        .collect()
}

fn cell_data<'a>(shown: &'a [Shown], has_meshes: bool, cost: CostMode) -> Vec<Array<'a>> {
    let mut arrays = vec![
        array("node", shown, |shown| shown.node.id),
        array("depth", shown, |shown| shown.node.depth),
        array("is_leaf", shown, |shown| u8::from(shown.node.is_leaf)),
        array("primitives", shown, |shown| shown.node.n_primitives),
        array("sah_cost", shown, |shown| shown.node.sah_cost),
        array("measured_cost", shown, |shown| shown.cost),
        array("visits", shown, |shown| shown.visits.n),
        array("hits", shown, |shown| shown.visits.n_hits),
        array("wasted_visits", shown, |shown| shown.visits.n_wasted()),
    ];
    if shown.iter().any(|shown| shown.node.epo.is_some()) {
        arrays.push(array("epo", shown, |shown| {
            shown.node.epo.unwrap_or_default()
        }));
    }
    if has_meshes {
        arrays.push(array("mesh", shown, |shown| {
            shown.node.mesh.map_or(-1, |mesh| mesh as i32)
        }));
    }
    if let Some(metric) = Metric::measured_by(cost) {
        let times = array(metric.name, shown, |shown| shown.visits.time_ns());
        arrays.push(times.in_unit(metric.unit_label()));
    }
    arrays
}

fn array<'a, E: Entry>(
    name: &'static str,
    shown: &'a [Shown],
    entry: fn(&Shown) -> E,
) -> Array<'a> {
    Array::new(name, shown.len(), move || shown.iter().map(entry))
}

/// Returns the types of the cells.
fn types<'a>(shown: &'a [Shown]) -> Array<'a> {
    let cell = |shown: &Shown| match shown.node.mesh {
        None => CellType::Voxel as u8,
        Some(_) => CellType::Hexahedron as u8,
    };
    Array::new("types", shown.len(), move || shown.iter().map(cell))
}

/// Returns the corners in the order of VTK_VOXEL: x varies fastest, z slowest; for nodes of a mesh
/// in the order of VTK_HEXAHEDRON, around one face and then around the opposite one.
fn corners(shown: &Shown, instances: Option<&Instances>) -> [Vec3; 8] {
    let corners = shown.node.bounds.corners();
    let placed = shown.node.mesh.zip(instances).map(|(mesh, instances)| {
        let first = instances.meshes()[mesh as usize].first;
        let place = |corner| instances.get(first).transform.world_point(corner);
        let [a, b, c, d, e, f, g, h] = corners.map(place);
        [a, b, d, c, e, f, h, g]
    });
    placed.unwrap_or(corners)
}
