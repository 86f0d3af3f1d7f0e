"""The Cornell box in 76 bands beside the same box in three channels: colours by surface, and why they differ.

Example: python tests/benchmarks/spectral_cornell.py

Three answers on the same patches and form factors: the 76 measured bands, turned into linear sRGB at the end; the box
in the three channels that are in use with it; and three channels made from the measured spectra under the lamp's
light, so that lamp and first reflection have the right colour.
"""

from __future__ import annotations

import argparse
from typing import Any, NamedTuple

import numpy as np

import radiosity as rad
from radiosity import colour
from radiosity.display import LUMINANCE_WEIGHTS
from radiosity.scenes import cornell_data

WHY = (
    "Nearly all of the difference is in the values in use, not in their being three: that lamp is whiter than the "
    "measured one, and those walls are brighter. Three values made from the spectra under the lamp's light agree with "
    "76 bands within what an eye can see on all but the red wall, where light that was reflected by the coloured walls "
    "before takes the product of two spectra, and three channels only the product of their means."
)


class Comparison(NamedTuple):
    """Mean radiosity of each surface, linear sRGB, (M, 3) each."""

    names: tuple[str, ...]
    spectral: Any
    in_use: Any
    from_spectra: Any


def from_spectra() -> tuple[dict[str, Any], Any]:
    """Reflectances in three channels under the lamp's light, and the lamp's radiance, from the measured spectra."""
    wavelengths = cornell_data.WAVELENGTHS
    lamp = np.interp(wavelengths, *np.array(cornell_data.LAMP_SPECTRUM).T)
    light = colour.spectrum_to_rgb(lamp, wavelengths)
    return {
        name: colour.spectrum_to_rgb(lamp * np.array(reflectance), wavelengths) / light
        for name, reflectance in cornell_data.REFLECTANCE.items()
    }, light


def compare(patch_count: int, rays: int, seed: int = 0) -> Comparison:
    """Solve all three on the same factors."""
    box, spectral = rad.scenes.cornell_box(), rad.scenes.cornell_box(spectral=True)
    patches, bands = (rad.subdivide(scene, patch_count=patch_count) for scene in (box, spectral))
    factors = rad.form_factors(patches, rad.MonteCarlo(rays, seed))
    solver = rad.Neumann(rtol=1e-6, keep_bytes=0)
    light = solver.solve(rad.TransportOperator(factors, bands), bands.emission).radiosity
    light = colour.spectrum_to_rgb(light, cornell_data.WAVELENGTHS)
    in_use = solver.solve(rad.TransportOperator(factors, patches), patches.emission).radiosity

    paints, lamp = from_spectra()
    of_surface = {
        "green_wall": paints["green"],
        "red_wall": paints["red"],
        "lamp": np.full(3, cornell_data.LAMP_REFLECTANCE),
    }
    names = patches.surface_names
    reflectance = np.array([of_surface.get(name, paints["white"]) for name in names])[patches.surface]
    emission = np.pi * lamp * (patches.surface == names.index("lamp"))[:, None]
    made = solver.solve(rad.TransportOperator(factors, reflectance=reflectance), emission).radiosity

    def by_surface(values):
        members = [patches.surface == k for k in range(len(names))]
        return np.array([np.average(values[these], axis=0, weights=patches.area[these]) for these in members])

    return Comparison(names, by_surface(light), by_surface(in_use), by_surface(made))


def differences(found, true) -> tuple[Any, Any]:
    """Luminance over that of the truth, and distance in u′, v′, of (M, 3) linear sRGB."""
    weights = np.array(LUMINANCE_WEIGHTS)
    return found @ weights / (true @ weights), colour.colour_difference(
        colour.rgb_to_xyz(found), colour.rgb_to_xyz(true)
    )


def main() -> None:
    """Print the table and the sentence."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--patches", type=int, default=1500)
    parser.add_argument("--rays", type=int, default=1024)
    options = parser.parse_args()
    found = compare(options.patches, options.rays)
    use, made = differences(found.in_use, found.spectral), differences(found.from_spectra, found.spectral)
    print("Mean radiosity, linear sRGB; Y / Y: luminance over that of 76 bands; Δu'v': 0.004 is just seen side by side")
    print(f"{'':12}{'76 bands':^24}{'RGB in use':^24}  Y / Y   Δu'v'  {'RGB from spectra':^24}  Y / Y   Δu'v'")
    for k, name in enumerate(found.names):
        cells = ["".join(f"{value:8.3f}" for value in values[k]) for values in found[1:]]
        print(
            f"{name:12}{cells[0]}{cells[1]}{use[0][k]:8.3f}{use[1][k]:8.4f}{cells[2]}{made[0][k]:8.3f}{made[1][k]:8.4f}"
        )
    print(f"\n{WHY}")
    paints, lamp = from_spectra()
    print("\nThe values themselves: in use, and from the spectra under the lamp's light")
    print(f"{'lamp':8}{np.array(cornell_data.RGB_LAMP_RADIANCE)}  {lamp.round(2)}")
    for name, values in paints.items():
        print(f"{name:8}{np.array(cornell_data.RGB[name])}  {values.round(3)}")


if __name__ == "__main__":
    main()
