"""Solutions as .vtp, VTK's XML polygons, for ParaView and others. Needs no GL."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import OutputError
from ..solution import Solution
from .atomic import replacing
from .provenance import provenance


def write_vtp(solution: Solution, path: Path) -> None:
    """Write all orders as arrays of the cells, whole or not at all.

    Cell i is patch i. Cell arrays, float64 with C components: order_00 … order_KK (T^k E), radiosity, irradiance,
    emission (W/m²), reflectance; and area (m²), surface (an index into the field array surface_names). The field
    array about holds versions, settings and statistics as JSON.

    Parameters
    ----------
    solution : Solution
    path : Path

    Raises
    ------
    OutputError
        VTK could not write, for instance because the disk is full.
    """
    from vtkmodules.vtkCommonCore import vtkObject
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    with replacing(path) as temporary:
        writer = vtkXMLPolyDataWriter()
        writer.SetFileName(str(temporary))
        writer.SetInputData(poly_data(solution))
        writer.SetCompressorTypeToNone()  # float64 hardly shrinks
        loud = vtkObject.GetGlobalWarningDisplay()
        vtkObject.SetGlobalWarningDisplay(0)  # VTK would print a page before the error below
        try:
            good = writer.Write() and not writer.GetErrorCode()
        finally:
            vtkObject.SetGlobalWarningDisplay(loud)
        if not good:
            code = writer.GetErrorCode()
            raise OutputError(f"cannot write {path}: VTK's error {code}, as on a full disk; the old file is as it was")


def poly_data(solution: Solution) -> Any:
    """The patches of a solution and their light as `vtkPolyData`."""
    from vtkmodules.vtkCommonCore import vtkPoints
    from vtkmodules.vtkCommonDataModel import vtkPolyData

    patches = solution.patches
    data = vtkPolyData()
    points = vtkPoints()
    points.SetData(_array(patches.vertices))
    data.SetPoints(points)
    data.SetPolys(_cells(patches.faces))
    for name, values in _cell_arrays(solution).items():
        data.GetCellData().AddArray(_array(values, name))
    about = {
        "format": "radiosity",
        "version": 1,
        **provenance(solution.scene),
        "scene": solution.scene.name,
        "status": solution.status,
        "settings": solution.settings,
        "statistics": solution.statistics,
    }
    data.GetFieldData().AddArray(_texts("surface_names", patches.surface_names))
    data.GetFieldData().AddArray(_texts("about", [json.dumps(about, default=str)]))
    data.GetCellData().SetActiveScalars("radiosity")
    return data


def _cell_arrays(solution: Solution) -> dict[str, NDArray[Any]]:
    """Arrays of the cells by name; the orders in the order of the bounces."""
    patches = solution.patches
    arrays: dict[str, NDArray[Any]] = {
        "radiosity": solution.radiosity,
        "irradiance": solution.irradiance,
        "emission": patches.emission,
        "reflectance": patches.reflectance,
        "area": patches.area,
        "surface": patches.surface,
    }
    orders = () if solution.orders is None else solution.orders
    digits = max(2, len(str(len(orders) - 1)))
    return arrays | {f"order_{k:0{digits}}": order for k, order in enumerate(orders)}


def _array(values: NDArray[Any], name: str = "") -> Any:
    """A VTK array with memory of its own."""
    from vtkmodules.util.numpy_support import numpy_to_vtk

    array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    array.SetName(name)
    return array


def _cells(faces: NDArray[np.int32]) -> Any:
    """Quads and triangles (N, 4), -1 padding a triangle, as `vtkCellArray`."""
    from vtkmodules.util.numpy_support import numpy_to_vtkIdTypeArray
    from vtkmodules.vtkCommonDataModel import vtkCellArray

    used = faces >= 0
    offsets = np.concatenate([[0], np.cumsum(used.sum(axis=1))]).astype(np.int64)
    cells = vtkCellArray()
    cells.SetData(
        numpy_to_vtkIdTypeArray(offsets, deep=True), numpy_to_vtkIdTypeArray(faces[used].astype(np.int64), deep=True)
    )
    return cells


def _texts(name: str, texts: Any) -> Any:
    from vtkmodules.vtkCommonCore import vtkStringArray

    array = vtkStringArray()
    array.SetName(name)
    for text in texts:
        array.InsertNextValue(text)
    return array
