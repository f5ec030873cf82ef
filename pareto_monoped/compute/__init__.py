"""Work spread over processes and machines: chunks, executors that survive lost workers, and who may compute."""
