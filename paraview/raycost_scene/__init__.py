"""What a VTK renderer shows, as a scene of raycost.

    from raycost_scene import raycost_scene
    scene = raycost_scene(plotter)          # PyVista's Plotter, or a vtkRenderer
    folder = scene.render()                 # image.png, frame.vti, cost.png, ...

Needs VTK alone, of PyPI or of ParaView. `paraview/raycost.py` is the plugin of ParaView that
uses it.
"""

from .errors import RaycostError
from .export import Scene, raycost_scene

__all__ = ["RaycostError", "Scene", "raycost_scene"]
