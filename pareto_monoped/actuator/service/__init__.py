"""What an actuator is good for beside torque and mass: bearings under load, losses by source, stiffness, backlash."""

__all__ = ["sheet"]
