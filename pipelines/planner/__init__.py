"""What pipelines/plan is made of: descriptions, step graphs, exports, the runner of a step, status and reports."""
