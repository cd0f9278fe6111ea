"""A macro of ParaView: renders the active view with raycost.

Macros > Import new macro... makes it a button of the window. The plugin `raycost.py` has to be
loaded: Tools > Manage Plugins > Load New...
"""

import sys

try:
    import raycost
except ImportError:
    print("raycost: load the plugin raycost.py first: Tools > Manage Plugins > Load New...", file=sys.stderr)
else:
    try:
        raycost.render_view()
    except raycost.RaycostError as error:
        print(f"raycost: {error}", file=sys.stderr)
