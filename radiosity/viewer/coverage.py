"""What share of each pixel every patch covers: then any colours of the patches become a picture at once.

A sheet shows the same room from the same place many times, in other light. So it is drawn once, with the number of
each patch as its colour; every picture after that is a sparse matrix times the patches' colours, as light.
"""

from __future__ import annotations

import numpy as np
import pyvista as pv
from numpy.typing import NDArray
from scipy.sparse import csr_array

from .. import display
from .drawing import BACKGROUND, Drawing
from .state import Series, ViewState

NOTHING = 0xFFFFFF  # the number of what is no patch: white


class Coverage:
    """Shares of patches in the pixels of one view.

    Parameters
    ----------
    drawing : Drawing
        Patches in a plotter of `samples` times as many pixels each way.
    series : Series
    state : ViewState
        Neither smooth nor with edges or backs: those are no plain colours of patches.
    samples : int
        Pixels of the plotter each way that make one of the picture.
    """

    def __init__(self, drawing: Drawing, series: Series, state: ViewState, samples: int) -> None:
        numbers = _numbers(drawing, series, state)
        self.height, self.width = (length // samples for length in numbers.shape)
        patch = np.where(numbers == NOTHING, len(series.area), numbers)
        pixel = np.arange(self.height * self.width).reshape(self.height, self.width)
        pixel = pixel.repeat(samples, axis=0).repeat(samples, axis=1)
        patch = patch[: pixel.shape[0], : pixel.shape[1]]
        share = np.full(pixel.size, 1.0 / samples**2, dtype=np.float32)
        shape = (self.height * self.width, len(series.area) + 1)
        self.shares = csr_array((share, (pixel.ravel(), patch.ravel())), shape=shape)

    def picture(self, colours: NDArray[np.uint8]) -> NDArray[np.uint8]:
        """Picture (height, width, 3) of patches in these colours (N, 3): means of light, not of codes."""
        background = np.array(pv.Color(BACKGROUND).int_rgb, dtype=np.uint8)
        light = display.decode_srgb(np.vstack([colours, background])).astype(np.float32)
        return display.encode_srgb(self.shares @ light).reshape(self.height, self.width, 3)


def _numbers(drawing: Drawing, series: Series, state: ViewState) -> NDArray[np.int64]:
    """The number of the patch that each pixel of the plotter shows, (height, width); `NOTHING` where there is none."""
    number = np.arange(len(series.area))
    window, smoothing = drawing.plotter.render_window, drawing.plotter.render_window.GetMultiSamples()
    window.SetMultiSamples(0)  # a mixture of two numbers is a third
    drawing.renderer.SetBackground(1.0, 1.0, 1.0)
    drawing.draw(series, state, np.column_stack([number >> 16, number >> 8 & 255, number & 255]).astype(np.uint8))
    drawing.plotter.render()
    image = np.asarray(drawing.plotter.screenshot(return_img=True)).astype(np.int64)
    drawing.renderer.SetBackground(pv.Color(BACKGROUND).float_rgb)
    window.SetMultiSamples(smoothing)
    return image[..., 0] << 16 | image[..., 1] << 8 | image[..., 2]
