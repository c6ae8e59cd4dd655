#!/usr/bin/env bash
# Installs what the tests need from the system, where it may; without it the tests that need it are skipped
# (in CI they fail: SLIPJUMP_CI=1).
set -u
missing=""
command -v mosquitto >/dev/null || [ -x /usr/sbin/mosquitto ] || missing="$missing mosquitto"
command -v chromium >/dev/null || command -v chromium-browser >/dev/null || missing="$missing chromium"
ls /usr/lib/postgresql/*/bin/initdb >/dev/null 2>&1 || missing="$missing postgresql"
[ -z "$missing" ] && exit 0
sudo=""; [ "$(id -u)" = 0 ] || sudo="sudo -n"
# shellcheck disable=SC2086 # names of packages
{ $sudo apt-get update -qq && $sudo apt-get install -y -qq --no-install-recommends $missing; } >/dev/null 2>&1 \
    || echo "could not be installed:$missing; the tests that need it will be skipped" >&2
exit 0
