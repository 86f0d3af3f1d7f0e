"""The viewer: a window, pictures, and a page, three faces of one state.

Nothing here loads a graphics library before something is drawn.
"""

from __future__ import annotations

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
