"""Progress to an experiment tracker: MLflow where it is installed, else to the screen. Nothing of it is needed."""

import pareto_monoped as pm

try:
    import mlflow
except ModuleNotFoundError:
    mlflow = None


def log(progress):
    """Called after each generation, which is then stored."""
    known = {"hypervolume": progress.hypervolume, "jumps_per_second": progress.per_second}
    if mlflow is None:
        print(f"{progress.evaluations} jumps: " + ", ".join(f"{name} {value:.2f}" for name, value in known.items()))
    else:
        mlflow.log_metrics(known, step=progress.evaluations)


study = pm.Study.define(name="logged", evaluations=160, seed=3)
if mlflow is not None:
    mlflow.set_tracking_uri("sqlite:///mlflow.db")
    mlflow.start_run(run_name=study.name)
    mlflow.log_params({"seed": study.seed, "algorithm": study.algorithm.name, "motor": study.motor_text})
stored = pm.run(study, "logged.db", callback=log)
if mlflow is not None:
    mlflow.log_artifact(str(stored.path))
    mlflow.end_run()
print(f"front of {len(stored.front())} designs")
