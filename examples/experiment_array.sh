#!/usr/bin/env bash
# An experiment spread over a cluster: a Slurm job array, each job one shard.
#   sbatch --array=1-16 --cpus-per-task=4 examples/experiment_array.sh exploration --finger all -n 400
# and when all have ended:
#   regrasp experiment merge results/shard-* -o results/all
# A job that was cut off goes on where it was when it is submitted again: --array=7.
# Other schedulers: set SLURM_ARRAY_TASK_ID (1 ... N) and SLURM_ARRAY_TASK_MAX (N) yourself.
#SBATCH --job-name=regrasp
#SBATCH --time=01:00:00
#SBATCH --output=results/%A-%a.log
set -euo pipefail

: "${SLURM_ARRAY_TASK_ID:?run me as a job array: sbatch --array=1-16 $0 exploration ...}"
shards=${REGRASP_SHARDS:-$SLURM_ARRAY_TASK_MAX}
results=${REGRASP_RESULTS:-results}

exec regrasp experiment "$@" \
  --shard "$SLURM_ARRAY_TASK_ID/$shards" \
  --workers "${SLURM_CPUS_PER_TASK:-1}" \
  -o "$results/shard-$SLURM_ARRAY_TASK_ID"
