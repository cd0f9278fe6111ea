"""Saves the views of a state as a picture, turned by an angle: pvbatch state_picture.py STATE FILE WIDTH HEIGHT DEGREES"""

import sys

from paraview import simple as pv

state, file, width, height, degrees = sys.argv[1:]
pv._DisableFirstRenderCameraReset()
pv.LoadState(state)
layout = pv.GetLayout()
size = [int(width), int(height)]
layout.SetSize(size)
if float(degrees) != 0:
    # All from one camera: linked views follow the first.
    views = pv.GetRenderViews()
    camera = views[0].GetActiveCamera()
    camera.Azimuth(float(degrees))
    for view in views:
        view.CameraPosition = camera.GetPosition()
        view.CameraViewAngle = 0.8 * view.CameraViewAngle
pv.SaveScreenshot(file, layout, ImageResolution=size)
