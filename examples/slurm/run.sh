#!/usr/bin/env bash
# A batch on a cluster with Slurm: an array of parts, then one job that merges them.
#
#   examples/slurm/run.sh PARTS OUT ARGUMENTS...      ARGUMENTS are those of `pairwave analyze` or `integrate`, without --out
#   examples/slurm/run.sh 64 result --sampler poisson-disk -n 4096 -k 1000000 --stats pcf,spectrum
#
# Of many files, FILES and how they are read before --, so that they are scanned once and each part reads its own files only:
#
#   examples/slurm/run.sh PARTS OUT FILES... [--class-column species ...] -- ARGUMENTS...
#
# The scan is OUT.scan; one that is there already is taken, so that parts of the same files are gone on with.
#
# A part that was stopped, killed or sent away is gone on with where it was when its index runs again: `sbatch --requeue` and
# `sbatch --array=17 ...` are safe. Without sbatch the same steps run here, one after the other.
set -euo pipefail
parts=$1 out=$2
shift 2
pairwave=${PAIRWAVE:-pairwave}
scan=()
for ((k = 1; k <= $#; k++)); do
    if [[ ${!k} == -- ]]; then
        scan=("$pairwave" scan "${@:1:k-1}" --quiet --out "$out.scan")
        shift "$k"
        set -- "$out.scan" "$@"
        [[ -e $out.scan ]] && scan=()
        break
    fi
done
part=("$pairwave" analyze "$@" --quiet --resume --checkpoint 60)
merge=("$pairwave" merge --quiet --out "$out")

if command -v sbatch >/dev/null; then
    after=()
    if ((${#scan[@]})); then
        after=("--dependency=afterok:$(sbatch --parsable --job-name=pairwave-scan --wrap "$(printf '%q ' "${scan[@]}")")")
    fi
    # A signal two minutes before the end of the job: what is done until then is kept.
    array=$(sbatch --parsable "${after[@]}" --requeue --array="1-$parts" --signal=INT@120 --job-name=pairwave \
        --wrap "$(printf '%q ' "${part[@]}") --threads \${SLURM_CPUS_PER_TASK:-1} --shard \$SLURM_ARRAY_TASK_ID/$parts --out $(printf '%q' "$out").parts/\$SLURM_ARRAY_TASK_ID")
    sbatch --dependency="afterok:$array" --job-name=pairwave-merge --wrap "$(printf '%q ' "${merge[@]}") $(printf '%q' "$out").parts/*"
else
    ((${#scan[@]})) && "${scan[@]}"
    for ((k = 1; k <= parts; k++)); do
        # A part that is whole is not done again: it says what it holds.
        "${part[@]}" --shard "$k/$parts" --out "$out.parts/$k"
    done
    "${merge[@]}" "$out".parts/*
fi
