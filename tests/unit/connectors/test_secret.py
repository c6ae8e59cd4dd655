"""A password is where the configuration says, and nowhere else."""

import pytest
from pydantic import ValidationError

from agent.settings import settings_of
from connectors.base import AccessDeniedError, ConfigError
from connectors.secret import Secret
from connectors.tls import Tls


def test_it_is_read_from_the_environment_anew_each_time(monkeypatch):
    secret = Secret(env="SLIPJUMP_TEST_SECRET")
    for value in ("first", "second"):
        monkeypatch.setenv("SLIPJUMP_TEST_SECRET", value)
        assert secret.read("password") == value
        assert value not in repr(secret)


def test_it_is_read_from_a_file_whose_path_names_a_variable(monkeypatch, tmp_path):
    (tmp_path / "broker").write_bytes(b" with blanks \r\n")
    monkeypatch.setenv("CREDENTIALS_DIRECTORY", str(tmp_path))
    assert Secret(file="$CREDENTIALS_DIRECTORY/broker").read("password") == " with blanks "


@pytest.mark.parametrize(
    ("secret", "said"),
    [
        (Secret(env="SLIPJUMP_NOT_SET"), "password: the environment variable SLIPJUMP_NOT_SET is not set"),
        (Secret(file="/no/such"), "password: /no/such cannot be read: No such file or directory"),
    ],
)
def test_one_that_is_not_there_is_reported_with_its_option(secret, said):
    with pytest.raises(AccessDeniedError, match=said):
        secret.read("password")


@pytest.mark.parametrize("plain", ["hunter2", 12345678])
def test_plain_text_is_a_fault_that_does_not_repeat_it(plain):
    raw = {"connections": {"broker": {"kind": "mqtt", "user": "u", "password": plain}}, "loops": []}
    with pytest.raises(ConfigError) as caught:
        settings_of(raw)
    said = "a secret does not belong in this file: write {env: NAME} or {file: PATH}"
    assert f"connections.broker.password: {said}" in caught.value.faults
    assert str(plain) not in str(caught.value)


@pytest.mark.parametrize("places", [{}, {"env": "A", "file": "B"}])
def test_it_has_one_place(places):
    with pytest.raises(ValidationError, match="expected one of"):
        Secret.model_validate(places)


def test_a_missing_authority_and_a_key_alone_are_reported(tmp_path):
    with pytest.raises(AccessDeniedError, match=r"tls\.ca: /no/such cannot be read"):
        Tls(ca="/no/such").context()
    (tmp_path / "ca.pem").write_text("no certificate")
    with pytest.raises(AccessDeniedError, match="holds no certificates"):
        Tls(ca=str(tmp_path / "ca.pem")).context()
    with pytest.raises(ValidationError, match="a key needs its certificate"):
        Tls(key="key.pem")
