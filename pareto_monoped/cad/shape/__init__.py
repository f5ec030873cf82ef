"""Part -> flat curves, gear teeth, triangle meshes."""
