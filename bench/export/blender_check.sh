#!/bin/sh
# Shows exported people in Blender beside the viewer's picture of the same camera, and says how far they differ:
#
#     bench/export/blender_check.sh BUILD RECORDING.mcap SITE TIME_S POSITION TARGET FOLDER
#     bench/export/blender_check.sh build evening.mcap alice 6 -4.3,0,1.5 -0.8,0,0.95 /tmp/pictures
#
# POSITION and TARGET are in the world, so a world server must have placed the site. By hand, not in CI: it needs Blender (Debian's 3.4 will
# do), python3-numpy and python3-pil. FOLDER gets the pictures: look at them.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
[ $# -eq 7 ] || { sed -n '2,8s/^# \{0,1\}//p' "$0"; exit 2; }
command -v blender > /dev/null || { echo "skipped: no Blender here (apt-get install blender python3-numpy)"; exit 0; }
/usr/bin/python3 -c "import numpy, PIL" 2> /dev/null || { echo "skipped: apt-get install python3-numpy python3-pil"; exit 0; }
bin=$1/bin recording=$2 site=$3 time=$4 position=$5 target=$6 folder=$7
fov=38 width=960 height=720
mkdir -p "$folder"

export_frame() { # FILE OPTIONS...: the first frame from $time on, in the world
    file=$1
    shift
    "$bin/export" "$recording" --site "$site" --from "$time" --frame world --log-level warn -o "$file" "$@"
}
render() { # FILE PICTURE [FOV PLACE TARGET]
    file=$1 to=$2
    shift 2
    blender --background --factory-startup --python-exit-code 1 --python "$here/blender_view.py" -- "$file" "$to" $width $height "$@" \
        > "$folder/blender.log" 2>&1 || { tail -5 "$folder/blender.log"; exit 1; }
}

cat > "$folder/path.json" <<END
{"keys": [{"time_s": 0, "position_m": [$position], "target_m": [$target], "fov_deg": $fov}]}
END
until=$(python3 -c "print($time + 0.5)")
export_frame "$folder/normals.glb" --to "$until"
export_frame "$folder/eye.glb" --to "$until" --path "$folder/path.json" --eye path
export_frame "$folder/frame.obj"
shown=$(sed -n 's/^# recording_s: //p' "$folder/frame.obj")
"$bin/viewer" "$recording" --headless --view.width $width --view.height $height --view.position_m "$position" --view.target_m "$target" \
    --view.adapt off --view.names off --view.shadows off --recording.from "$(python3 -c "print($shown + 0.003)")" --recording.paused \
    --seconds 3 --output "$folder/viewer.png" > "$folder/viewer.log" 2>&1
for name in normals.glb frame.obj eye.glb; do
    case $name in
    eye.glb) render "$folder/$name" "$folder/$name.png" ;; # by the camera in it
    *) render "$folder/$name" "$folder/$name.png" $fov $(echo "$position $target" | tr , ' ') ;;
    esac
    printf '%-12s ' "$name"
    /usr/bin/python3 "$here/compare_views.py" "$folder/$name.png" "$folder/viewer.png" "$folder/$name.beside.png"
done
