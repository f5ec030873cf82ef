"""Stage 3: a robot's parts as solids, assembled, checked and written to files that can be made and simulated.

Order of imports, lowest first: assembly, check.result, drawing.paper, drawing.profile, kernel.client, picture.drawing,
shape.outlines, write.folder, write.formulas; as_built, cables, drawing.bores, drawing.dimension, drawing.sheet,
interrupt, jobs, kernel.solids, kernel.step, picture.labels, shape.meshes, write.drivers; check.retention,
drawing.data_tables, drawing.plan, drawing.section, film, kernel.process, product, write.dxf, write.equations; bodies,
check.making, check.mass, check.overlap, check.screws, check.watertight, drawing.assembly_views, drawing.end_view,
write.living, write.meshes, write.readme, write.tables; check.free_motion, check.gear_mesh, drawing.assembly_sheets,
drawing.plan_sheet, steps, write.mjcf, write.urdf; check.run, drawing.part_sheet, picture.scenes; drawing.drawings,
write.assembly_pack; write.files; export; records; batch.
"""

__all__ = ["batch", "export", "film", "interrupt", "jobs", "kernel", "records", "write"]
