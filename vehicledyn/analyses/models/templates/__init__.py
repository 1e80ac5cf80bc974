"""Files to begin with, as "vehicledyn init" writes them: KIND_model.yaml, KIND_scenario.yaml."""
