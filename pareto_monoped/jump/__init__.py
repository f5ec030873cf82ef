"""Stage 2: a robot becomes a MuJoCo model, jumps under the paper's controller, and its jump is measured."""
