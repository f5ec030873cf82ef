"""Flat shapes, prismatic parts and their exact mass properties: what both the simulation and the CAD are made from."""
