"""Stage 3: a robot's parts as solids, assembled, checked and written to files that can be made and simulated.

Order of imports, lowest first: check.result, drawing.paper, drawing.profile, kernel.client, picture.drawing,
shape.outlines, shape.stacks, write.folder; drawing.bores, drawing.dimension, drawing.sheet, interrupt, jobs,
kernel.solids, kernel.step, picture.labels, shape.meshes; drawing.data_tables, drawing.plan, drawing.section,
kernel.process, product, write.dxf; as_built, cables, check.mass, check.overlap, check.retention, check.watertight,
drawing.assembly_views, drawing.end_view, film, write.meshes, write.parameters; bodies, check.free_motion, check.screws,
drawing.assembly_sheets, drawing.plan_sheet, write.design_record, write.mjcf, write.readme, write.tables, write.urdf;
check.run, drawing.part_sheet, steps; drawing.drawings, picture.scenes; write.assembly_pack, write.files; export;
records; batch.
"""

__all__ = ["batch", "export", "film", "interrupt", "jobs", "kernel", "records", "write"]
