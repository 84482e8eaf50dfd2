#!/bin/bash
# with_slurm.sh COMMAND...: runs a command beside a Slurm of its own on this machine, and ends that
# afterwards. Status 77, and the reason, where there cannot be one. Everything of it lies in one
# temporary folder, with ports and keys of its own: another Slurm here is not disturbed.
set -u

skip() {
    echo "skipped: $*"
    exit 77
}
((EUID == 0)) || skip "starting a Slurm takes root"
for program in munged slurmctld slurmd sbatch scancel squeue; do
    command -v "$program" >/dev/null || [[ -x /usr/sbin/$program ]] ||
        skip "there is no $program (Debian: slurm-wlm, munge)"
done
PATH=$PATH:/usr/sbin

base=$(mktemp -d "${TMPDIR:-/tmp}/slurm.XXXXXX")
chmod 755 "$base"

# Ends a process that was started here, by the file that holds its id.
end() {
    local pid
    pid=$(cat "$base/$1.pid" 2>/dev/null) || return 0
    [[ $pid =~ ^[0-9]+$ ]] && kill "$pid" 2>/dev/null || return 0
    for _ in {1..50}; do
        kill -0 "$pid" 2>/dev/null || return 0
        sleep 0.1
    done
    kill -KILL "$pid" 2>/dev/null
}
finish() {
    # Jobs are ended by the controller, whose tasks are nobody else's to end.
    scancel --full --signal=KILL --me 2>/dev/null
    scancel --me 2>/dev/null
    for _ in {1..30}; do
        [[ $(squeue --noheader --states=running,completing 2>/dev/null) ]] || break
        sleep 0.1
    done
    end slurmd
    end slurmctld
    end munged
    rm -rf "$base"
}
trap finish EXIT
trap 'exit 130' INT TERM

free_port() {
    local port
    while port=$((20000 + RANDOM)); do
        (exec 3<>"/dev/tcp/127.0.0.1/$port") 2>/dev/null || break
    done
    echo "$port"
}
# A lone socket, key and seed; munge wants their folders to be nobody else's, which /tmp is not.
head -c 1024 /dev/urandom >"$base/key"
chmod 400 "$base/key"
munged --force --socket="$base/munge" --key-file="$base/key" --pid-file="$base/munged.pid" \
    --log-file="$base/munged.log" --seed-file="$base/seed" 2>"$base/munged.err" ||
    skip "munged does not start: $(tail -1 "$base/munged.err")"

host=$(hostname -s)
mkdir "$base/state" "$base/spool"
cat >"$base/slurm.conf" <<CONF
ClusterName=test
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$(free_port)
SlurmdPort=$(free_port)
AuthType=auth/munge
AuthInfo=socket=$base/munge
CredType=cred/munge
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$base/state
SlurmdSpoolDir=$base/spool
SlurmctldPidFile=$base/slurmctld.pid
SlurmdPidFile=$base/slurmd.pid
SlurmctldLogFile=$base/slurmctld.log
SlurmdLogFile=$base/slurmd.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
SwitchType=switch/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerParameters=sched_interval=1,batch_sched_delay=0,sched_min_interval=100000
ReturnToService=2
SlurmdParameters=config_overrides
KillWait=2
NodeName=$host NodeAddr=127.0.0.1 CPUs=2 State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES
CONF
export SLURM_CONF=$base/slurm.conf
export CHROMEBALL_TEST_SLURM=$base # tells the tests that this one is theirs
unset SLURM_JOB_ID SLURM_ARRAY_TASK_ID SLURM_CPUS_PER_TASK
slurmctld -c 2>"$base/slurmctld.err" || skip "slurmctld does not start: $(tail -1 "$base/slurmctld.err")"
slurmd 2>"$base/slurmd.err" || skip "slurmd does not start: $(tail -1 "$base/slurmd.err")"
for _ in {1..100}; do
    [[ $(sinfo --noheader --format=%t 2>/dev/null) == idle ]] && break
    sleep 0.1
done
[[ $(sinfo --noheader --format=%t) == idle ]] || {
    tail -5 "$base"/*.log
    skip "the node does not become idle"
}
"$@"
