#!/usr/bin/env bash
# Flies the default scene in a window of a virtual display, presses keys as a person would, and looks at the report that
# the program prints when it is told to leave. Usage: tests/test_window.sh OVERFLY. Exit 77: skipped.
set -u -o pipefail
if [ "${2-}" != inside ]; then
    for tool in xvfb-run xauth xdotool python3; do
        command -v "$tool" >/dev/null || {
            echo "skipped: $tool is missing"
            exit 77
        }
    done
    exec xvfb-run -a -s "-screen 0 1280x800x24" "$0" "$1" inside
fi

overfly=$1
work=$(mktemp -d)
pid=
finish() {
    [ -z "$pid" ] || kill "$pid" 2>/dev/null
    rm -rf "$work"
}
trap finish EXIT
for name in $(compgen -e OVERFLY_); do
    [ "$name" = OVERFLY_DATA_DIR ] || unset "$name"
done
export HOME=$work XDG_CONFIG_HOME=$work/config XDG_PICTURES_DIR=$work/pictures
mkdir -p "$XDG_PICTURES_DIR"
faults=0

# wait_for SECONDS COMMAND...: tries 50 times a second.
wait_for() {
    local tries=$(($1 * 50))
    shift
    until "$@"; do
        tries=$((tries - 1))
        [ "$tries" -gt 0 ] || return 1
        kill -0 "$pid" 2>/dev/null || return 1
        sleep 0.02
    done
}
has_ended() { ! kill -0 "$pid" 2>/dev/null; }

give_up() {
    echo "$flight: $1"
    cat "$work/log"
    exit 1
}

# take_off NAME OPTIONS...: until the first picture of the flight is on disk, and with it the window on the screen.
take_off() {
    flight=$1
    shift
    rm -rf "$work/frames"
    "$overfly" --json --fps 20 --pictures "$work/frames" --picture-count 1 "$@" >"$work/report" 2>"$work/log" &
    pid=$!
    wait_for 30 test -s "$work/frames/overfly-001.png" || give_up "no picture came"
}

# Presses one key after another.
press() { xdotool key --delay 60 "$@"; }
# hold SECONDS KEY...: all at once.
hold() {
    local seconds=$1
    shift
    xdotool keydown "$@"
    sleep "$seconds"
    xdotool keyup "$@"
}

land() {
    press Escape
    wait_for 10 has_ended || [ -z "$(jobs -r)" ] || give_up "Esc did not end it"
    wait "$pid"
    local status=$?
    pid=
    [ "$status" -eq 0 ] || give_up "expected exit status 0 after Esc, found $status"
}

# Whether the flight's log, with -v, has a line that begins so, for the COUNTth time (1 if not given).
has_said() { [ "$(grep -c "$1" "$work/log")" -ge "${2-1}" ]; }

# A value of the last flight's report.
value() { sed -n 's/^[[:space:]]*"'"$1"'":[[:space:]]*"\{0,1\}\([^",]*\).*/\1/p' "$work/report" | head -n 1; }

# expect NAME RELATION VALUE
expect() {
    local found
    found=$(value "$1")
    if awk -v a="$found" -v b="$3" "BEGIN { exit !(a != \"\" && a $2 b) }"; then
        echo "$flight: $1 = $found, as expected $2 $3"
    else
        echo "$flight: expected $1 $2 $3, found ${found:-nothing}"
        faults=$((faults + 1))
    fi
}

# corners FILE: "WIDTHxHEIGHT" of an RGB PNG of 8 bits, then for each corner the mean and the range of its brightness.
corners() {
    python3 - "$1" <<'EOF'
import struct, sys, zlib
data, at, packed = open(sys.argv[1], "rb").read(), 8, b""
while at < len(data):
    length, kind = struct.unpack(">I4s", data[at:at + 8])
    body, at = data[at + 8:at + 8 + length], at + 12 + length
    if kind == b"IHDR":
        width, height, bits, colour = struct.unpack(">IIBB", body[:10])
    packed += body if kind == b"IDAT" else b""
assert (bits, colour) == (8, 2), f"{bits} bits, colour type {colour}"
raw, stride, rows = zlib.decompress(packed), 3 * width, [bytearray(3 * width)]
for y in range(height):
    method, row, above = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)]), rows[-1]
    for x in range(stride if method else 0):
        a, b, c = row[x - 3] if x > 2 else 0, above[x], above[x - 3] if x > 2 else 0
        to = {key: abs(a + b - c - value) for value, key in ((a, 0), (b, 1), (c, 2))}
        paeth = (a, b, c)[min(to, key=lambda k: (to[k], k))] if method == 4 else 0
        row[x] = (row[x] + (0, a, b, (a + b) // 2, paeth)[method]) & 255
    rows.append(row)
print(f"{width}x{height}")
for name, y0, x0 in (("top_left", 0, 0), ("top_right", 0, width - 24), ("bottom_left", height - 24, 0),
                     ("bottom_right", height - 24, width - 24)):
    block = [sum(rows[1 + y][3 * x:3 * x + 3]) for y in range(y0, y0 + 24) for x in range(x0, x0 + 24)]
    print(name, sum(block) // len(block), max(block) - min(block))
EOF
}

# Resizes the window; the next picture has its size, with sky in the upper corners and land, which is never of one
# colour, in the lower ones.
expect_resized() {
    local size="$1x$2" picture found
    xdotool windowsize --sync "$(xdotool search --onlyvisible --name '^Overfly' | head -n 1)" "$1" "$2"
    sleep 0.5
    rm -f "$XDG_PICTURES_DIR"/overfly-*.png
    press F3
    wait_for 10 compgen -G "$XDG_PICTURES_DIR/overfly-*.png" >/dev/null || give_up "F3 wrote no picture"
    sleep 0.3
    picture=$(compgen -G "$XDG_PICTURES_DIR/overfly-*.png" | head -n 1)
    found=$(corners "$picture")
    echo "$flight: resized to $size: ${found//$'\n'/, }"
    awk -v size="$size" 'NR == 1 { bad += $1 != size } NR > 1 { bad += $2 < 60 } /^bottom/ { bad += $3 < 12 }
        END { exit bad || NR != 5 }' <<<"$found" && return
    echo "$flight: expected $size, brightness from 60 on in all corners, and a range from 12 on in the lower ones"
    faults=$((faults + 1))
}

take_off "no keys" --size 1280x800
land
expect frames '>=' 1
expect bank_deg '<' 1
expect bank_deg '>' -1
expect tau_px '==' 1
throttle=$(value throttle) pitch=$(value pitch_deg)

take_off "right, more throttle" --size 1280x800
press t t t w l F3
hold 1.0 Right Prior
wait_for 10 compgen -G "$XDG_PICTURES_DIR/overfly-*.png" >/dev/null || give_up "F3 wrote no picture"
land
expect bank_deg '>' 5
expect throttle '>' "$(awk "BEGIN { print $throttle + 0.05 }")"
expect tau_px '<' 0.51
expect tau_px '>' 0.49
expect wireframe '==' true
expect colouring '==' level
expect window '==' true

take_off "left, less throttle" --size 640x400 -v
press T h x m
wait_for 30 has_said "left half: patch" || give_up "m brought no other method"
hold 0.5 Left Next
land
expect bank_deg '<' -5
expect throttle '<' "$(awk "BEGIN { print $throttle - 0.05 }")"
expect tau_px '>' 1.2
expect method '==' patch
expect numbers '==' false
expect hud '==' true
expect fov_deg '<' 60

take_off "stick forward" --size 640x400
hold 0.5 Up
land
expect pitch_deg '<' "$(awk "BEGIN { print $pitch - 2 }")"

take_off "stick back" --size 640x400
hold 0.5 Down
land
expect pitch_deg '>' "$(awk "BEGIN { print $pitch + 2 }")"

take_off "pause and help" --size 640x400
press p F1
hold 0.5 Right
land
expect paused '==' true
expect help '==' true
expect bank_deg '<' 1

take_off "accuracy" --size 640x400 -v
press F2
wait_for 60 has_said "accuracy: a cut of hybrid is measured" || give_up "F2 measured nothing"
wait_for 60 has_said "accuracy: other tolerances are sampled" || give_up "F2 sampled nothing"
press t t t
sleep 2.5
land
expect accuracy_panel '==' true
expect state '==' measured
expect max_px '<=' "$(value promised_px)"
expect cracks '==' 0
expect age_s '>=' 0
panel_has() { # TAU FLOWN: a point within a tenth
    python3 - "$work/report" "$@" <<'EOF'
import json, sys
panel, tau, flown = json.load(open(sys.argv[1]))["accuracy"], float(sys.argv[2]), sys.argv[3] == "flown"
sys.exit(not any(abs(point["tau_px"] / tau - 1) < 0.1 and point["flown"] == flown for point in panel["curve"]) or
         abs(panel["tau_px"] - 0.5) > 0.01)
EOF
}
for point in "1 flown" "0.5 flown" "8 sampled"; do
    # shellcheck disable=SC2086 # two words
    panel_has $point && echo "$flight: $point px, as expected" && continue
    echo "$flight: expected a point $point px, and the present one at 0.5 px"
    faults=$((faults + 1))
done

take_off "accuracy, coarser, closed" --size 640x400 --accuracy
press T T T F2
land
expect accuracy_panel '==' false
expect tau_px '>' 1.99

take_off "resized" --size 640x400
press p h
expect_resized 900 600
expect_resized 480 520
land

methods="hybrid patch roam roam-parallel geomipmap geomipmap-ye diamond brute"
take_off "all methods" --size 640x400 -v
for method in ${methods#hybrid } hybrid; do
    press m
    wait_for 60 has_said "left half: $method," || give_up "m did not bring $method"
done
press c
wait_for 60 has_said "right half: patch," || give_up "c brought no second method"
for method in ${methods#hybrid patch } hybrid; do
    press M
    wait_for 60 has_said "right half: $method," || give_up "M did not bring $method"
done
press c l l m c
wait_for 60 has_said "right half: roam," 2 || give_up "c brought no second method again"
sleep 0.5
land
expect method '==' patch
expect compare '==' true
expect colouring '==' cache
expect method_changes '==' 18
expect method_refusals '==' 0
expect frames_compared '>=' 8
for method in $methods; do
    expect "$method" '>=' 1
done
expect p50 '>' 0
expect longest_first_refine_ms '>' 0
echo "$flight: longest frame $(value longest_frame_ms) ms, longest first refinement $(value longest_first_refine_ms) ms"

take_off "compared from the start" --size 640x400 --compare brute
press m M m c
land
expect compare_wanted '==' false
expect method_refusals '==' 0

echo "$faults values were not as expected"
[ "$faults" -eq 0 ]
