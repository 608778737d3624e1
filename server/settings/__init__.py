"""Every setting of the server: what there is, and where each value comes from."""

from server.settings.addresses import is_loopback
from server.settings.fields import DATABASE_NAME, LARGEST_PRIORITY, Limits, Settings
from server.settings.reading import ReadSettings, read_settings
from server.settings.sources import Setting, SettingsError, ShownSetting

__all__ = [
    "DATABASE_NAME",
    "LARGEST_PRIORITY",
    "Limits",
    "ReadSettings",
    "Setting",
    "Settings",
    "SettingsError",
    "ShownSetting",
    "is_loopback",
    "read_settings",
]
