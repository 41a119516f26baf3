#!/usr/bin/env bash
# Makes the certificates by which the computers of one robot know each other:
#   make_certificates.sh FOLDER supervisor base arm
# FOLDER/ca.pem and FOLDER/NAME.pem with FOLDER/NAME.key belong on the computer of that name. With
# FOLDER/ca.key anybody can make a computer of the robot: it belongs on none of them. What is there
# already is kept, so that a further computer can be added later.
set -euo pipefail
umask 077

# Valid from long ago: a robot without internet may start with the clock of years ago.
FROM=20000101000000Z
UNTIL=$(($(date +%Y) + 20))0101000000Z

die() {
    echo "make_certificates.sh: $1" >&2
    exit 2
}

[ $# -ge 2 ] || die "usage: make_certificates.sh FOLDER NAME..."
command -v openssl >/dev/null || die "openssl is not installed"
FOLDER=$1
shift
for name in "$@"; do
    [[ $name =~ ^[a-z][a-z0-9_-]{0,62}$ ]] || die "'$name' is not the name of a computer"
    [ "$name" != ca ] || die "'ca' is the name of the files of the authority"
done
mkdir -p "$FOLDER"
FOLDER=$(cd "$FOLDER" && pwd)
WORK=$(mktemp -d)
trap 'rm -rf "$WORK"' EXIT

cat >"$WORK/openssl.cnf" <<'EOF'
[req]
distinguished_name = name
[name]
[ca]
default_ca = robot
[robot]
dir = .
database = index.txt
new_certs_dir = .
default_md = sha256
policy = policy
rand_serial = yes
unique_subject = no
[policy]
commonName = supplied
[authority]
basicConstraints = critical, CA:TRUE, pathlen:0
keyUsage = critical, keyCertSign, cRLSign
subjectKeyIdentifier = hash
[computer]
basicConstraints = critical, CA:FALSE
keyUsage = critical, digitalSignature
extendedKeyUsage = serverAuth, clientAuth
subjectAltName = DNS:${ENV::COMPUTER}
subjectKeyIdentifier = hash
authorityKeyIdentifier = keyid
EOF
cd "$WORK"
: >index.txt
export COMPUTER=ca

# Runs openssl, and shows what it says only if it fails.
quietly() {
    openssl "$@" </dev/null >log 2>&1 || {
        cat log >&2
        die "openssl $1 failed"
    }
}

new_key() {
    quietly genpkey -algorithm EC -pkeyopt ec_paramgen_curve:P-256 -out "$1"
}

# Signs the key $1 as $2, with the extensions $3 and further arguments.
sign() {
    local key=$1 name=$2 extensions=$3
    shift 3
    quietly req -new -config openssl.cnf -key "$key" -subj "/CN=$name" -out request.pem
    quietly ca -batch -config openssl.cnf -in request.pem -notext -out signed.pem \
        -extensions "$extensions" -startdate "$FROM" -enddate "$UNTIL" "$@"
}

if [ -e "$FOLDER/ca.pem" ]; then
    [ -e "$FOLDER/ca.key" ] || die "$FOLDER/ca.key is missing: only with it can more be made"
else
    new_key ca.key
    sign ca.key "robot $(openssl rand -hex 4)" authority -selfsign -keyfile ca.key
    mv ca.key signed.pem "$FOLDER"
    mv "$FOLDER/signed.pem" "$FOLDER/ca.pem"
fi
for COMPUTER in "$@"; do
    if [ -e "$FOLDER/$COMPUTER.pem" ]; then
        echo "$FOLDER/$COMPUTER.pem is kept"
        continue
    fi
    new_key computer.key
    sign computer.key "$COMPUTER" computer -cert "$FOLDER/ca.pem" -keyfile "$FOLDER/ca.key"
    mv computer.key "$FOLDER/$COMPUTER.key"
    mv signed.pem "$FOLDER/$COMPUTER.pem"
    echo "$FOLDER/$COMPUTER.pem is made"
done
chmod a+r "$FOLDER"/*.pem
