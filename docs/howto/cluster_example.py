"""Form factors on a dask cluster of two processes: brought here, and left there."""

import numpy as np

import radiosity as rad
from radiosity.form_factors.cluster import form_factors_on_cluster


def main() -> None:
    """Compute on two processes, solve where the rows are, and compare."""
    from dask.distributed import Client, LocalCluster  # pip install "radiosity[cluster]"

    patches = rad.subdivide(rad.scenes.cornell_box(), patch_count=3_000)
    method = rad.MonteCarlo(rays=128)
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=":0") as cluster, Client(cluster) as client:
        here = rad.form_factors(patches, method, executor=client.get_executor())

        there = form_factors_on_cluster(patches, method, client=client)
        T = rad.TransportOperator(there, patches)
        result = rad.Neumann(rtol=1e-4).solve(T, patches.emission, sky=patches.sky)

    again = rad.Neumann(rtol=1e-4).solve(rad.TransportOperator(here, patches), patches.emission, sky=patches.sky)
    print(f"{there.non_zeros:,} non-zeros in {len(there.parts)} blocks of rows; {result.status}")
    print("same bits:", np.array_equal(result.radiosity, again.radiosity))


if __name__ == "__main__":  # worker processes import this file
    main()
