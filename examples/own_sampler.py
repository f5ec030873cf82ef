"""A study under a sampler and a storage of Optuna's."""

import optuna

import pareto_monoped as pm

objective = pm.OptunaObjective(pm.Study.define(name="sampled", evaluations=100, motor=["VT8020", "U8"]))
study = optuna.create_study(
    storage="sqlite:///sampled.db",
    directions=objective.directions,
    sampler=optuna.samplers.NSGAIISampler(seed=1, population_size=20),
)
study.optimize(objective, n_trials=100)
for trial in sorted(study.best_trials, key=lambda one: one.values[0]):
    print(f"trial {trial.number}: {trial.values[0]:.3f} m on {trial.values[1]:.1f} J with {trial.params['motor']}")
