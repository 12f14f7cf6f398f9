"""A certificate for one run: nobody but the front of this run trusts it."""

import datetime
import ipaddress
from typing import NamedTuple

from elbowroom.extras import package

DAYS = 3650


class Certificate(NamedTuple):
    """Both as PEM.

    Args:
        certificate: for 127.0.0.1.
        key: its private key, which stays in this process.
    """

    certificate: bytes
    key: bytes


def made_certificate() -> Certificate:
    """A new one, signed by itself.

    Raises:
        PackageError: cryptography is missing.
    """
    x509, hashes = package("cryptography.x509"), package("cryptography.hazmat.primitives.hashes")
    serialization = package("cryptography.hazmat.primitives.serialization")
    curves = package("cryptography.hazmat.primitives.asymmetric.ec")
    key = curves.generate_private_key(curves.SECP256R1())
    name = x509.Name([x509.NameAttribute(x509.NameOID.COMMON_NAME, "elbowroom")])
    now = datetime.datetime.now(datetime.UTC)
    address = x509.SubjectAlternativeName([x509.IPAddress(ipaddress.ip_address("127.0.0.1"))])
    signed = (
        x509.CertificateBuilder()
        .subject_name(name)
        .issuer_name(name)
        .public_key(key.public_key())
        .serial_number(x509.random_serial_number())
        .not_valid_before(now - datetime.timedelta(days=1))
        .not_valid_after(now + datetime.timedelta(days=DAYS))
        .add_extension(address, critical=False)
        .add_extension(x509.BasicConstraints(ca=True, path_length=0), critical=True)
        .sign(key, hashes.SHA256())
    )
    kind = serialization
    secret = key.private_bytes(kind.Encoding.PEM, kind.PrivateFormat.PKCS8, kind.NoEncryption())
    return Certificate(signed.public_bytes(kind.Encoding.PEM), secret)
