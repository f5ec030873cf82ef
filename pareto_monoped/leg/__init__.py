"""The leg: sandwich links with a chain drive to the knee, the foot, and the base frame that carries the actuators."""
