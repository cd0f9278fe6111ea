//! `surface.vtu`: the cost of each primitive, on the scene's geometry.

use std::io::{self, Seek, Write};

use vtkio::model::CellType;

use super::file::{FileContent, OutputFile};
use super::points::points;
use render::attribution::Visits;
use scene::config::{CostMode, OptionalOutput};
use tracer::cost::Metric;
use vtk::appended;
use vtk::array::{Array, Entry, Integers};
use vtk::data_set::{CellMesh, DataSet};
use vtk::encoding::Encoding;
use world::geometry::{InstanceTransform, LENGTH_UNIT, Patch, RenderSpace};
use world::scene::{Instances, Primitive, Scene};

/// The file.
pub(super) const FILE: OutputFile = OutputFile {
    name: "surface.vtu",
    is_wanted: |request| request.has(OptionalOutput::Surface),
    content: FileContent::Written(|job, out| {
        let rendering = job.rendering;
        let visits = rendering.attribution.and_then(|of| of.primitives.as_ref());
        let (scene, cost) = (rendering.scene, rendering.film.cost);
        visits.map_or(Ok(()), |visits| {
            write(scene, visits, cost, job.encoding(), out)
        })
    }),
};

/// The primitives that are written.
#[derive(Clone, Copy)]
struct Surface<'a> {
    primitives: &'a [Primitive],
    instances: Option<&'a Instances>,
    visits: &'a [Visits],
    space: RenderSpace,
    n_cells: usize,
}

/// Writes the scene's primitives except planes as an UnstructuredGrid of one cell each, in their
/// order: triangles, polygons for disks, hexahedra for boxes, triangle strips for ellipsoids,
/// cylinders, cones and capsules, and vertices with a `radius` for spheres. `visits` has one entry
/// per primitive; times are written only if `cost` includes them.
///
/// An instanced mesh is shown once, at its first instance, with the costs of all instances; each
/// instance is shown as its box.
pub fn write(
    scene: &Scene,
    visits: &[Visits],
    cost: CostMode,
    encoding: impl Into<Encoding>,
    out: &mut (impl Write + Seek),
) -> io::Result<()> {
    let primitives = &scene.primitives;
    let is_shown = |primitive: &&Primitive| !primitive.is_unbounded();
    let surface = Surface {
        primitives,
        instances: scene.instances.as_ref(),
        visits,
        space: scene.space,
        n_cells: primitives.iter().filter(is_shown).count(),
    };
    let n_points = surface.ends().last().unwrap_or(0);
    let ids = Integers::up_to(n_points);
    let mesh = CellMesh {
        n_points,
        n_cells: surface.n_cells,
        point_data: Vec::new(),
        cell_data: surface.cell_data(cost),
        points: surface.points(n_points),
        cells: vec![
            ids.array("connectivity", n_points, |out| {
                ids.write_multiples(1, 0..n_points, out)
            }),
            surface.offsets(ids),
            Array::new("types", surface.n_cells, || {
                surface.patches().map(|patch| cell_type(&patch) as u8)
            }),
        ],
    };
    appended::write(&DataSet::Grid(mesh), encoding.into(), out)
}

impl<'a> Surface<'a> {
    /// Returns the index, the primitive and the visits of each cell.
    fn cells(self) -> impl Iterator<Item = (usize, &'a Primitive, &'a Visits)> {
        let all = self.primitives.iter().zip(self.visits).enumerate();
        all.map(|(index, (primitive, visits))| (index, primitive, visits))
            .filter(|(_, primitive, _)| !primitive.is_unbounded())
    }

    fn patches(self) -> impl Iterator<Item = Patch> {
        let all = (0..).zip(self.primitives);
        all.filter_map(move |(index, primitive)| {
            let patch = primitive.patch()?;
            Some(match self.first_place(index) {
                None => patch,
                Some(transform) => patch.placed(transform),
            })
        })
    }

    /// Returns the placement of the first instance of the mesh that contains the primitive with
    /// this index, if there is one.
    fn first_place(self, index: u32) -> Option<&'a InstanceTransform> {
        let instances = self.instances?;
        let mesh = &instances.meshes()[instances.mesh_with(index)? as usize];
        Some(&instances.get(mesh.first).transform)
    }

    /// Returns the additional arrays of a scene with instances: the instance that a box shows, and
    /// the mesh that a triangle belongs to; else -1.
    fn instance_arrays(self) -> Option<[Array<'a>; 2]> {
        let instances = self.instances?;
        let array = |name, number: fn(&Instances, u32) -> Option<u32>| {
            let number = move |(index, _, _): (usize, &Primitive, &Visits)| {
                number(instances, index as u32).map_or(-1, |number| number as i32)
            };
            Array::new(name, self.n_cells, move || self.cells().map(number))
        };
        let instance = |instances: &Instances, index: u32| {
            let instance = instances.by_box(index);
            instance
                .filter(|id| (id.0 as usize) < instances.n_instances())
                .map(|id| id.0)
        };
        Some([
            array("instance", instance),
            array("mesh", Instances::mesh_with),
        ])
    }

    /// Returns the end of each cell's points among all points.
    fn ends(self) -> impl Iterator<Item = usize> {
        self.patches().scan(0, |end, patch| {
            *end += patch.corners().len();
            Some(*end)
        })
    }

    fn points(self, n: usize) -> Array<'a> {
        points(&self.space, n, move || {
            self.patches().flat_map(|patch| patch.corners().to_vec())
        })
    }

    fn offsets(self, ids: Integers) -> Array<'a> {
        let (name, n) = ("offsets", self.n_cells);
        match ids {
            Integers::I32 => Array::new(name, n, move || self.ends().map(|end| end as i32)),
            Integers::I64 => Array::new(name, n, move || self.ends().map(|end| end as i64)),
        }
    }

    fn cell_data(self, cost: CostMode) -> Vec<Array<'a>> {
        let radius = move |patch| self.space.world_length(radius(&patch));
        let radii = move || self.patches().map(radius);
        let mut arrays = vec![
            self.array("primitive", |index, _, _| index as u32),
            self.array("object", |_, primitive, _| primitive.object.0 as i32),
            self.array("material", |_, primitive, _| primitive.material.0 as i32),
            Array::new("radius", self.n_cells, radii).in_unit(LENGTH_UNIT),
            self.array("tests", |_, _, visits| visits.n),
            self.array("hits", |_, _, visits| visits.n_hits),
            self.array("wasted_tests", |_, _, visits| visits.n_wasted()),
        ];
        arrays.extend(self.instance_arrays().into_iter().flatten());
        if let Some(metric) = Metric::measured_by(cost) {
            let times = self.array(metric.name, |_, _, visits| visits.time_ns());
            arrays.push(times.in_unit(metric.unit_label()));
        }
        arrays
    }

    fn array<E: Entry>(
        self,
        name: &'static str,
        entry: fn(usize, &Primitive, &Visits) -> E,
    ) -> Array<'a> {
        let entry = move |(index, primitive, visits)| entry(index, primitive, visits);
        Array::new(name, self.n_cells, move || self.cells().map(entry))
    }
}

/// Returns a sphere's radius, 0 for other shapes.
fn radius(patch: &Patch) -> f32 {
    match patch {
        Patch::Ball { radius, .. } => *radius,
        _ => 0.0,
    }
}

fn cell_type(patch: &Patch) -> CellType {
    match patch {
        Patch::Ball { .. } => CellType::Vertex,
        Patch::Triangle(_) => CellType::Triangle,
        Patch::Polygon(_) => CellType::Polygon,
        Patch::Box(_) => CellType::Hexahedron,
        Patch::Strip(_) => CellType::TriangleStrip,
    }
}
