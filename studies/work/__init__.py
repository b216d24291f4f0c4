"""The executor: jobs on processes of this machine or on Dask workers."""
