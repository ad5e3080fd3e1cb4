#!/usr/bin/env bash
# A real Slurm on one machine, loopback only, for tests/test_slurm.py. Debian 12 (Slurm 22.05.8), root; needs no systemd,
# no cgroups, no accounting database, no second host.
#
#   slurm-recipe.sh install   apt packages (slurmctld slurmd slurm-client munge)
#   slurm-recipe.sh start     write slurm.conf, start munged, slurmctld, slurmd(s)
#   slurm-recipe.sh status    sinfo and a one-task smoke test
#   slurm-recipe.sh stop      stop only the daemons started here (by PID file)
#
# Environment (all optional):
#   SLURM_NODES   virtual compute nodes, each its own slurmd (default 2)
#   SLURM_CPUS    CPUs per node (default: number of CPUs / SLURM_NODES, at least 1)
#   SLURM_MEM_MB  memory per node (default: 75 % of RAM / SLURM_NODES)
set -euo pipefail

CONF=/etc/slurm/slurm.conf
RUN=/run/slurm
STATE=/var/lib/slurm
LOG=/var/log/slurm
HOST=$(hostname -s)
NODES=${SLURM_NODES:-2}
CPUS=${SLURM_CPUS:-$(( $(nproc) / NODES > 0 ? $(nproc) / NODES : 1 ))}
MEM=${SLURM_MEM_MB:-$(awk -v n="$NODES" '/MemTotal/ {print int($2/1024*0.75/n)}' /proc/meminfo)}

install_pkgs() {
    apt-get update -q
    DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends \
        slurmctld slurmd slurm-client munge
}

write_conf() {
    install -d -m 0755 /etc/slurm
    cat > "$CONF" <<EOF
ClusterName=loopback
# the name must equal "hostname -s"; the address in brackets pins it to loopback
SlurmctldHost=${HOST}(127.0.0.1)
# bind to that address, not to every interface
CommunicationParameters=NoCtldInAddrAny,NoInAddrAny
AuthType=auth/munge
CredType=cred/munge
SlurmUser=slurm
SlurmdUser=root
SlurmctldPort=6817
SlurmctldPidFile=${RUN}/slurmctld.pid
SlurmdPidFile=${RUN}/slurmd-%n.pid
StateSaveLocation=${STATE}/ctld
SlurmdSpoolDir=${STATE}/d-%n
SlurmctldLogFile=${LOG}/slurmctld.log
SlurmdLogFile=${LOG}/slurmd-%n.log
# nothing that needs cgroups
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
# no database: sacct fails, so keep finished jobs visible to squeue for a day
AccountingStorageType=accounting_storage/none
MinJobAge=86400
MaxJobCount=20000
MaxArraySize=10001
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU_Memory
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_min_interval=100000,bf_interval=5
ReturnToService=2
InactiveLimit=0
KillWait=5
NodeName=c[1-${NODES}] NodeHostname=${HOST} NodeAddr=127.0.0.1 Port=[17001-$((17000 + NODES))] CPUs=${CPUS} RealMemory=${MEM} State=UNKNOWN
PartitionName=main Nodes=c[1-${NODES}] Default=YES MaxTime=INFINITE State=UP DefMemPerCPU=500
EOF
}

alive() { [ -s "$1" ] && kill -0 "$(cat "$1")" 2>/dev/null; }

start() {
    if alive "$RUN/slurmctld.pid"; then echo "already running"; sinfo -N; return; fi
    write_conf
    install -d -o munge -g munge -m 0755 /run/munge
    install -d -o munge -g munge -m 0700 /var/log/munge /var/lib/munge
    install -d -o slurm -g slurm -m 0755 "$RUN" "$STATE" "$STATE/ctld" "$LOG"
    if [ ! -s /etc/munge/munge.key ]; then
        install -o munge -g munge -m 0400 /dev/null /etc/munge/munge.key
        head -c 1024 /dev/urandom > /etc/munge/munge.key
    fi
    alive /run/munge/munged.pid || setpriv --reuid=munge --regid=munge --clear-groups \
        /usr/sbin/munged --pid-file=/run/munge/munged.pid
    munge -n | unmunge > /dev/null
    # -i: start although there is no (or an outdated) saved state
    /usr/sbin/slurmctld -i
    for _ in $(seq 50); do scontrol ping 2>/dev/null | grep -q 'is UP' && break; sleep 0.2; done
    for k in $(seq "$NODES"); do
        install -d -o root -g root -m 0755 "$STATE/d-c$k"
        alive "$RUN/slurmd-c$k.pid" || /usr/sbin/slurmd -N "c$k"
    done
    for _ in $(seq 100); do
        [ "$(sinfo -h -N -o %T 2>/dev/null | grep -c '^idle$')" = "$NODES" ] && break; sleep 0.2
    done
    sinfo -N
}

status() {
    scontrol ping
    sinfo -N
    srun -N "$NODES" --mem=100 sh -c 'echo "task on $SLURMD_NODENAME"'
}

stop() {
    for f in "$RUN"/slurmd-c*.pid "$RUN/slurmctld.pid" /run/munge/munged.pid; do
        if alive "$f"; then kill "$(cat "$f")"; fi
    done
}

case "${1:-}" in
    install) install_pkgs ;;
    start) start ;;
    status) status ;;
    stop) stop ;;
    *) sed -n '2,16p' "$0"; exit 2 ;;
esac
