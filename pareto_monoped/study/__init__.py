"""Studies: study file, search algorithms behind one ask-and-tell interface, run loop, storage, resume."""
