#!/usr/bin/env bash
# Build the wheel, install it in a clean environment outside the checkout, and run a tiny case from there.
set -euo pipefail
python=$1
checkout=$(pwd)
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$python" -m pip wheel --quiet --no-deps --wheel-dir "$folder" "$checkout"
"$python" - "$folder"/trisk-*.whl <<'EOF'
import sys
import zipfile

strangers = {name for name in zipfile.ZipFile(sys.argv[1]).namelist() if name.startswith(("docs/", "tests/"))}
strangers |= {name for name in zipfile.ZipFile(sys.argv[1]).namelist() if "mesh_page" in name or "mesh_report" in name}
assert not strangers, strangers
EOF
"$python" -m venv "$folder/venv"
"$folder/venv/bin/python" -m pip install --quiet "$folder"/trisk-*.whl
cd "$folder"
venv/bin/trisk mesh --cells 162 -o mesh.nc
venv/bin/trisk run williamson5 --mesh mesh.nc --days 1 -o run
venv/bin/trisk plot run
test -s run/figures/potential_vorticity.png
venv/bin/trisk view run -o run.html
test -s run.html
venv/bin/python - <<'EOF'
import json
import pathlib
import mesh

status = json.loads(pathlib.Path("run/run.json").read_text())["status"]
assert status == "completed", status
assert "site-packages" in mesh.__file__, mesh.__file__
EOF
echo "the wheel works outside the checkout"
