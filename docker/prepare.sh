#!/bin/sh
# Makes what the services of compose.yaml share, unless it is there: the certificate that lets
# coordinator, scheduler and workers into each other, and the bucket (a folder of the object store).
#     prepare.sh CERTIFICATES BUCKET
set -eu
umask 077
certificates=$1
bucket=$2

mkdir -p "$bucket"

month=2592000
if openssl x509 -checkend "$month" -noout -in "$certificates/certificate.pem" >/dev/null 2>&1; then
    echo "the certificate in $certificates is valid for another month"
    exit 0
fi
# Its own authority: whoever holds this one key and certificate belongs to the cluster.
openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:P-256 -noenc -days 3650 \
    -subj /CN=trainbridge -addext basicConstraints=critical,CA:TRUE \
    -keyout "$certificates/key.new" -out "$certificates/certificate.new" 2>/dev/null
mv "$certificates/key.new" "$certificates/key.pem"
mv "$certificates/certificate.new" "$certificates/certificate.pem"
echo "a new certificate is in $certificates"
