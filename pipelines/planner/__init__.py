"""What pipelines/plan is made of: descriptions, step graphs, exports, the runner of steps, status, goldens and reports."""

VERSION = "0.1.0"  # of rt-tools
