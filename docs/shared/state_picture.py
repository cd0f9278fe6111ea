"""Saves the views of a state as a picture: pvbatch state_picture.py STATE FILE WIDTH HEIGHT"""

import sys

from paraview import simple as pv

state, file, width, height = sys.argv[1:]
pv._DisableFirstRenderCameraReset()
pv.LoadState(state)
layout = pv.GetLayout()
size = [int(width), int(height)]
layout.SetSize(size)
pv.SaveScreenshot(file, layout, ImageResolution=size)
