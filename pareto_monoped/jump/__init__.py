"""Stage 2, physics: a robot becomes a MuJoCo model, jumps under the paper's controller, and is measured."""
