#!/usr/bin/env bash
# tools/attack/faults.sh [--seconds S] [--seed N] [--hb PROGRAM]: faults of the machine around `hb` for S seconds (60):
# kills at random moments, full disks, little memory, scenes with bytes changed. Each must leave what was computed, end
# with a known status and say why. Prints counts; exit status 1 where something was lost, with the folder kept.
set -euo pipefail

cd "$(dirname "${BASH_SOURCE[0]}")/../../tests/scenes"
seconds=60 seed=1 hb=$PWD/../../build/release/bin/hb
while (($#)); do
  case $1 in
    --seconds) seconds=$2 ;;
    --seed) seed=$2 ;;
    --hb) hb=$2 ;;
    *)
      echo "faults.sh: found $1, allowed: --seconds S, --seed N, --hb PROGRAM" >&2
      exit 2
      ;;
  esac
  shift 2
done
RANDOM=$seed
work=$(mktemp -d)
failures=0
declare -A count

# fault WHAT: something was lost.
fault() {
  echo "LOST: $*" >&2
  failures=$((failures + 1))
}
counted() { count[$1]=$((${count[$1]:-0} + 1)); }
begun=$SECONDS
# left SHARE: seconds of a share (in percent of the whole) are not used up.
left() { ((SECONDS - begun < seconds * $1 / 100)); }
# A pause of 0 to $1 milliseconds.
pause() { sleep "$(printf '0.%03d' $((RANDOM * 3 % $1)))"; }
# No raw control characters but tabs and new lines.
clean() { ! LC_ALL=C grep -q '[^[:print:][:space:]]' <(LC_ALL=C tr -d '\200-\377' <"$1"); }
known() { [[ " $2 " == *" $1 "* ]]; }

# The step of the sweep: the less time, the fewer speeds.
step=$((seconds < 60 ? 120 / seconds : 2))
jobs=(
  "sweep six_link.toml --rpm 1000:2500:$step --only steady,stability --modes 4"
  "map mathieu.toml --x omega=1:2.6:300 --y hill.stiffness.1.cos.0.0=0.1:0.6:200"
)

# run JOB FOLDER FLAGS...: one of them into a folder, going on where parts are left.
run() {
  local -a line flags=("${@:3}")
  read -ra line <<<"$1"
  [[ -e $2.part ]] && flags+=(--resume)
  ${in_place:-} "$hb" "${line[@]}" --out "$2" "${flags[@]}"
}
# The same in place of the shell that calls it: its process is the one of `hb`.
exec_run() { in_place="exec" run "$@"; }

# kills JOB NAME SHARE: kills at random moments until its share of the time is used up, then --resume until it ends: the
# same bytes as without. 143: TERM before hb looked for it.
kills() {
  local job=$1 name=$2 share=$3 status=0 round child signals=(KILL INT TERM)
  run "$job" "$work/whole" --no-plots >"$work/whole.txt" 2>"$work/whole.err" || status=$?
  known $status "0 3" || fault "$name: status $status: $(cat "$work/whole.err")"
  for ((round = 0; round < 40; ++round)); do
    exec_run "$job" "$work/parts" --no-plots >"$work/parts.txt" 2>"$work/parts.err" &
    child=$!
    pause 900
    kill -"${signals[RANDOM % 3]}" $child 2>/dev/null || true
    status=0
    wait $child || status=$?
    counted "kills"
    known $status "130 137 143" || break
    left "$share" || break
  done
  if known $status "130 137 143"; then
    status=0
    run "$job" "$work/parts" --no-plots >"$work/parts.txt" 2>"$work/parts.err" || status=$?
  fi
  known $status "0 3" || fault "$name: after kills status $status: $(cat "$work/parts.err")"
  diff -r "$work/whole" "$work/parts" >&2 || fault "$name: another answer after kills"
  cmp "$work/whole.txt" "$work/parts.txt" >&2 || fault "$name: another table after kills"
  [[ ! -e $work/parts.part && ! -e $work/parts.lock ]] || fault "$name: parts or a lock left behind"
  rm -rf "$work/whole" "$work/parts"* "$work"/whole.*
}

# A disk that is full after some kilobytes, at the start and at a resume: finished parts stay, the table is printed. (Not
# killed: that may leave half a part, which a resume rightly takes away.)
full_disks() {
  local blocks=$((1 + RANDOM % 60)) job=${jobs[RANDOM % ${#jobs[@]}]} status before=0 child
  exec_run "$job" "$work/disk" --no-plots >/dev/null 2>&1 &
  child=$!
  pause 700
  kill -TERM $child 2>/dev/null || true
  wait $child 2>/dev/null || true
  [[ -e $work/disk.part ]] && before=$(stat -c %s "$work/disk.part") && cp "$work/disk.part" "$work/kept"
  {
    (
      ulimit -f $blocks
      status=0
      run "$job" "$work/disk" 2>"$work/disk.err" || status=$?
      echo $status >"$work/status"
    ) | cat >"$work/disk.txt"
  } || true
  status=$(cat "$work/status")
  counted "full disks"
  known "$status" "0 2 3 4" || fault "full disk of $blocks blocks: status $status: $(cat "$work/disk.err")"
  # 150 bytes: the head, without any part.
  if ((status == 2 && before > 150)); then
    cmp -n "$before" "$work/disk.part" "$work/kept" >&2 || fault "full disk of $blocks blocks: parts are gone"
  fi
  if ((status == 2)) && [[ ! -s $work/disk.txt ]] && ! grep -q "cannot be written" "$work/disk.err"; then
    fault "full disk of $blocks blocks: neither a table nor a reason"
  fi
  rm -rf "$work"/disk* "$work/kept" "$work/status"
}

# Little memory: an answer, or a sentence; never a crash.
little_memory() {
  local kilobytes=$((30000 + RANDOM * 8)) status=0
  (
    ulimit -v $kilobytes
    "$hb" steady six_link.toml --rpm $((300 + RANDOM % 3000)) --modes $((1 + RANDOM % 12))
  ) >"$work/memory.txt" 2>"$work/memory.err" || status=$?
  counted "little memory"
  # 127: the program itself does not fit.
  known $status "0 1 2 3 127" || fault "$kilobytes kB of memory: status $status: $(cat "$work/memory.err")"
}

# Bytes of a scene changed, removed, doubled.
mutated() {
  local -a all=(*.toml)
  local scene=${all[$((RANDOM % ${#all[@]}))]} status=0 size k at
  cp "$scene" "$work/scene.toml"
  cp ./*.csv "$work"
  size=$(stat -c %s "$scene")
  for ((k = 0; k <= RANDOM % 4; ++k)); do
    at=$(((RANDOM * 32768 + RANDOM) % size))
    case $((RANDOM % 3)) in
      0) { head -c $at "$scene"; printf '%b' "\\x$(printf %x $((RANDOM % 256)))"; tail -c +$((at + 2)) "$scene"; } >"$work/scene.toml" ;;
      1) { head -c $at "$scene"; tail -c +$((at + 2 + RANDOM % 9)) "$scene"; } >"$work/scene.toml" ;;
      2) { head -c $at "$scene"; printf '%s' $((RANDOM % 10)); tail -c +$((at + 1)) "$scene"; } >"$work/scene.toml" ;;
    esac
  done
  (
    cd "$work"
    timeout --signal=KILL 5 "$hb" steady scene.toml --rpm 300
  ) >"$work/mutated.txt" 2>"$work/mutated.err" || status=$?
  counted "mutated scenes"
  # 137: killed by the timeout, a scene that takes long.
  ((status != 137)) || counted "of them slow"
  if ! known $status "0 1 2 3 137"; then
    cp "$work/scene.toml" "$work/scene-$failures.toml"
    fault "mutated $(basename "$scene"): status $status: $(tail -1 "$work/mutated.err")"
  fi
  [[ $status == 2 && ! -s $work/mutated.err ]] && fault "mutated $(basename "$scene"): refused without a reason"
  clean "$work/mutated.err" || fault "mutated $(basename "$scene"): control characters on the terminal"
}

# Two runs at once into one folder: one is refused, the other one's answer is whole.
two_at_once() {
  local first=0 second=0 child
  run "${jobs[0]}" "$work/two" --no-plots >/dev/null 2>&1 &
  child=$!
  run "${jobs[0]}" "$work/two" --no-plots >/dev/null 2>&1 || second=$?
  wait $child || first=$?
  counted "two at once"
  if ! { known $first "0 3" && known $second "0 2 3"; } && ! { known $second "0 3" && known $first "2"; }; then
    fault "two at once: status $first and $second"
  fi
  [[ -s $work/two/sweep.json && ! -e $work/two.lock && ! -e $work/two.part ]] || fault "two at once: no whole answer"
  rm -rf "$work"/two*
}

kills "${jobs[0]}" sweep 20
kills "${jobs[1]}" map 40
two_at_once
# Some of each kind, however little time there is.
for attack in full_disks:55 little_memory:70 mutated:100; do
  for ((k = 0; k < 3; ++k)); do "${attack%:*}"; done
  while left "${attack#*:}"; do "${attack%:*}"; done
done

for what in "${!count[@]}"; do printf '%-16s %6d\n' "$what" "${count[$what]}"; done | sort
if ((failures)); then
  echo "$failures faults; files in $work" >&2
  exit 1
fi
rm -rf "$work"
echo "nothing lost"
