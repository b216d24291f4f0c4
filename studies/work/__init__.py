"""Who does jobs: processes of this machine or Dask workers; what they make results with, and how long they take."""
