"""One ensemble on this machine and on a Dask cluster: the same bits.

Needs `pip install distributed`. Put the address of a scheduler in place of the local cluster.
"""

import numpy as np

import stiction as st


def main() -> None:
    """Scan the creep rate over a hold, here and there."""
    motor = st.Motor(0.0076, friction=st.FrictionModel("hsieh_pan"))
    effort = np.concatenate([np.linspace(0.0, 0.134, 500), np.full(9500, 0.134)])
    rates = {"creep_rate": np.geomspace(0.2, 8.0, 24)}
    here = st.simulate_ensemble(motor, effort, 2e-4, parameters=rates, reduce="last")
    try:
        from distributed import Client, LocalCluster
    except ImportError:
        print("distributed is not installed: run on this machine alone")
    else:
        with (
            LocalCluster(n_workers=2, processes=False, dashboard_address=None) as cluster,
            Client(cluster) as client,
        ):
            there = st.simulate_ensemble(
                motor,
                effort,
                2e-4,
                parameters=rates,
                reduce="last",
                executor=client.get_executor(),
            )
        print("the same bits:", np.array_equal(here.position, there.position))
    for rate, position in zip(rates["creep_rate"][::6], here.position[::6], strict=True):
        print(f"creep rate {rate:5.2f} 1/s: {position / 4.8481e-6:.2f} arc-seconds after 2 s")


if __name__ == "__main__":
    main()
