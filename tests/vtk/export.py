"""Exports what VTK's renderers show, renders it with raycost, and compares.

    RAYCOST=PROGRAM python export.py CASE FOLDER

A case is one of the functions `case_...`; it fails by an exception. FOLDER gets the scenes and
both pictures. Needs PyVista.
"""

import os
import sys
import warnings
from pathlib import Path

import numpy as np
import pyvista as pv

sys.path.append(str(Path(__file__).parents[2] / "paraview"))
from raycost_scene import RaycostError, raycost_scene  # noqa: E402

warnings.simplefilter("ignore")
pv.OFF_SCREEN = True
SIZE = (320, 240)


def plotter():
    made = pv.Plotter(window_size=SIZE, lighting="none")
    made.set_background((0.1, 0.2, 0.3))
    return made


def ball(**kwargs):
    found = pv.Sphere(theta_resolution=80, phi_resolution=80, **kwargs)
    found["height"] = found.points[:, 2] + 0.6
    return found


def both(shown, folder, **options):
    """The scene, and the pictures of VTK and of raycost."""
    folder.mkdir(parents=True, exist_ok=True)
    shown.show(auto_close=False)
    expected = shown.screenshot(str(folder / "vtk.png"))[..., :3].astype(int)
    scene = raycost_scene(shown, folder, **options)
    out = scene.render()
    found = pv.read(out / "image.png")["PNGImage"].reshape(SIZE[1], SIZE[0], -1)[::-1, :, :3].astype(int)
    return scene, found, expected


def inner(expected, found, width=2):
    """Pixels that are away from edges, in both pictures."""
    mask = np.ones(expected.shape[:2], bool)
    for picture in (expected, found):
        for axis in (0, 1):
            jump = np.abs(np.diff(picture, axis=axis)).max(axis=2) > 24
            edge = np.zeros_like(mask)
            edge[tuple(slice(0, n) for n in jump.shape)] |= jump
            for shift in range(-width, width + 1):
                mask &= ~np.roll(edge, shift, axis)
    return mask


def assert_alike(found, expected, share=0.99, level=3):
    mask = inner(expected, found)
    assert mask.mean() > 0.5, f"{mask.mean():.2f} of the picture is compared"
    near = np.abs(found - expected).max(axis=2) <= level
    assert near[mask].mean() >= share, f"{near[mask].mean():.4f} of the pixels are within {level}"
    shown = np.abs(expected - expected[0, 0]).max(axis=2) > 8
    assert shown.mean() > 0.02, "the picture shows nothing"


def case_flat_colors(folder):
    """Perceptual, custom, reversed and coarse maps, log scales, NaN: all as VTK shows them."""
    for number, colors in enumerate(
        (
            dict(cmap="viridis"),
            dict(cmap="turbo", log_scale=True, clim=(0.05, 1.2)),
            dict(cmap="coolwarm_r", n_colors=5),
            dict(cmap=["black", "#ff8000", "white"], clim=(0.3, 0.8)),
        )
    ):
        surface = ball()
        surface["height"][surface.points[:, 0] > 0.3] = np.nan
        shown = plotter()
        shown.add_mesh(
            surface,
            scalars="height",
            interpolate_before_map=True,
            nan_color="magenta",
            lighting=False,
            show_scalar_bar=False,
            **colors,
        )
        scene, found, expected = both(shown, folder / str(number))
        assert scene.warnings == []
        assert_alike(found, expected)


def case_lit(folder):
    """Headlights and light kits shade as in VTK, highlights too."""
    for number, lighting in enumerate(("headlight", "kit")):
        shown = plotter()
        if lighting == "kit":
            shown.enable_lightkit()
        else:
            shown.add_light(pv.Light(light_type="headlight"))
        shown.add_mesh(ball(), color="tan", smooth_shading=True, specular=0.4, specular_power=20, ambient=0.1)
        shown.add_mesh(ball(center=(0.9, 0.2, 0.3)), color="teal", smooth_shading=True)
        _, found, expected = both(shown, folder / str(number))
        mean = np.abs(found - expected).mean()
        print(f"{lighting}: mean difference {mean:.2f}/255")
        assert mean < 1.5
        assert_alike(found, expected, 0.97, 8)


def case_points_with_radii(folder):
    """A radius by an array, 0 and negative ones left out; and a constant one."""
    points = pv.PolyData(np.array([[x, 0.0, 0.1 * x] for x in range(6)]))
    points["size"] = np.array([0.0, 0.1, 0.2, 0.3, 0.4, -1.0], np.float32)
    shown = plotter()
    actor = shown.add_mesh(points, style="points_gaussian", scalars="size", show_scalar_bar=False)
    actor.mapper.SetScaleArray("size")
    actor.mapper.SetScaleFactor(1.5)
    shown.view_xz()
    scene, _, _ = both(shown, folder)
    read = pv.read(next(folder.glob("*.vtp")))
    assert np.allclose(read["raycost radius"], [0.15, 0.3, 0.45, 0.6]), read["raycost radius"]
    assert np.allclose(read.points[:, 0], [1, 2, 3, 4])
    frame = pv.read(folder / "out/frame.vti")
    assert (frame["object"] >= 0).sum() > 1000, "no spheres are seen"


def case_lines_as_tubes(folder):
    """Lines are as wide as VTK draws them, and have their colors."""
    t = np.linspace(0, 6 * np.pi, 400)
    line = pv.lines_from_points(np.c_[np.cos(t), np.sin(t), t / 8])
    line["time"] = t
    shown = plotter()
    shown.add_mesh(line, scalars="time", line_width=6, lighting=False, show_scalar_bar=False)
    scene, found, expected = both(shown, folder)
    assert "tubes" in scene.file.read_text()
    covered = [(np.abs(picture - picture[0, 0]).max(axis=2) > 30).mean() for picture in (found, expected)]
    assert 0.8 < covered[0] / covered[1] < 1.25, covered


def case_transforms_and_cameras(folder):
    """Matrices of actors, parallel projection, and what is hidden."""
    shown = plotter()
    moved = shown.add_mesh(pv.Cube(), color="orange", lighting=False)
    moved.position, moved.scale = (0.5, 0.2, 0), (1, 2, 0.5)
    moved.RotateZ(30)
    hidden = shown.add_mesh(pv.Sphere(radius=3), color="red", lighting=False)
    hidden.visibility = False
    shown.enable_parallel_projection()
    shown.camera_position = [(4, 3, 5), (0.3, 0, 0), (0, 1, 0)]
    shown.camera.parallel_scale = 1.5
    scene, found, expected = both(shown, folder)
    assert scene.file.read_text().count("mesh:") == 1
    assert "orthographic" in scene.file.read_text()
    assert_alike(found, expected)


def case_surfaces(folder):
    """Unstructured grids by cells, edges, opacity, blocks with their own colors."""
    grid = pv.ImageData(dimensions=(4, 4, 4)).cast_to_unstructured_grid()
    grid["number"] = np.arange(27.0)
    shown = plotter()
    shown.add_mesh(grid, scalars="number", show_edges=True, line_width=2, lighting=False, show_scalar_bar=False)
    scene, found, expected = both(shown, folder / "edges")
    assert "tubes" in scene.file.read_text()
    assert_alike(found, expected)
    shown = plotter()
    blocks = pv.MultiBlock({"left": pv.Cube(), "right": pv.Cube().translate((2, 0, 0))})
    shown.add_composite(blocks, color="white", lighting=False)[0].mapper.block_attr[2].color = "green"
    scene, found, expected = both(shown, folder / "blocks")
    assert_alike(found, expected)
    shown = plotter()
    shown.add_mesh(pv.Cube(), color="red", opacity=0.4, lighting=False, culling=False)
    shown.camera_position = "xy"
    _, found, expected = both(shown, folder / "opacity", samples_per_pixel=256)
    middle = np.s_[110:130, 150:170]
    difference = np.abs(found[middle].mean(axis=(0, 1)) - expected[middle].mean(axis=(0, 1))).max()
    assert difference < 8, (found[middle].mean(axis=(0, 1)), expected[middle].mean(axis=(0, 1)))


def case_textures(folder):
    """Pictures by texture coordinates."""
    texels = np.zeros((32, 32, 3), np.uint8)
    texels[:16, :16], texels[16:, 16:] = (255, 120, 0), (0, 100, 200)
    shown = plotter()
    shown.add_mesh(pv.Plane(), texture=pv.Texture(texels), lighting=False)
    scene, found, expected = both(shown, folder)
    assert scene.warnings == []
    assert_alike(found, expected)


def case_directions_of_light(folder):
    """Points, spots and their cones."""
    shown = plotter()
    shown.add_mesh(pv.Plane(i_resolution=200, j_resolution=200, i_size=4, j_size=4), color="white")
    shown.add_light(pv.Light(position=(1, 1, 2), focal_point=(0, 0, 0), cone_angle=30, positional=True))
    shown.add_light(pv.Light(position=(-1, 0, 1), color="blue", intensity=0.4, positional=True, cone_angle=90))
    shown.camera_position = [(0, 0, 8), (0, 0, 0), (0, 1, 0)]
    _, found, expected = both(shown, folder)
    assert np.abs(found - expected).mean() < 6, np.abs(found - expected).mean()


def case_what_cannot_be_shown(folder):
    """A warning each, and the rest is there."""
    shown = plotter()
    shown.add_volume(pv.Wavelet(), name="the wave")
    shown.add_mesh(pv.Cube(), name="cube")
    shown.add_text("title")
    shown.set_background("black", top="white")
    scene, _, _ = both(shown, folder)
    said = "\n".join(scene.warnings)
    for part in ("the wave: a volume cannot be exported", "text", "gradient"):
        assert said.count(part) == 1, said
    assert "mesh:" in scene.file.read_text()


def case_names(folder):
    """Quotes, colons, other scripts and the same name twice."""
    shown = plotter()
    for number, name in enumerate(('a "quoted": name', "größe #5 {x}", "\N{SNOWMAN}\t'", "it's, [y]", "x" * 300)):
        surface = ball(center=(number, 0, 0))
        surface[name] = surface["height"]
        shown.add_mesh(surface, scalars=name, name=name, show_scalar_bar=False)
    scene, _, _ = both(shown, folder / "a folder with 'spaces' ü")
    assert scene.file.read_text(encoding="utf-8").count("mesh:") == 5


def case_nothing(folder):
    """An empty view is no scene, and leaves no file."""
    shown = plotter()
    shown.show(auto_close=False)
    try:
        raycost_scene(shown, folder)
    except RaycostError as error:
        assert str(error) == "the view shows nothing that can be exported"
    else:
        raise AssertionError("nothing is a scene")
    assert not any(folder.iterdir())


def case_files_of_others(folder):
    """They stay as they are; an earlier scene is replaced."""
    shown = plotter()
    shown.add_mesh(pv.Cube())
    shown.show(auto_close=False)
    for _ in range(2):
        raycost_scene(shown, folder / "own")
    other = folder / "other" / "scene.yaml"
    other.parent.mkdir()
    other.write_text("objects: []\n")
    try:
        raycost_scene(shown, other.parent)
    except RaycostError as error:
        assert "scene.yaml would be replaced" in str(error)
    else:
        raise AssertionError("a scene of others is replaced")
    assert [file.name for file in other.parent.iterdir()] == ["scene.yaml"]
    assert other.read_text() == "objects: []\n"


def case_no_program(folder):
    """A message says how to install it."""
    shown = plotter()
    shown.add_mesh(pv.Cube())
    shown.show(auto_close=False)
    scene = raycost_scene(shown, folder)
    os.environ["PATH"] = ""
    for variable, message in (("RAYCOST", "which the variable RAYCOST names"), (None, "cargo install")):
        os.environ.pop("RAYCOST", None)
        if variable:
            os.environ[variable] = "/no/such/program"
        try:
            scene.render()
        except RaycostError as error:
            assert message in str(error), error
        else:
            raise AssertionError("it has rendered")


def main():
    case, folder = sys.argv[1], Path(sys.argv[2])
    folder.mkdir(parents=True, exist_ok=True)
    globals()[f"case_{case}"](folder)


main()
