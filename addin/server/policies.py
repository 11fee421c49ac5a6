"""What a browser may load for a page of this server: headers of every answer.

The page for the browser takes nothing from elsewhere and stands in no frame. That of the Office add-in
stands in the frames of Office on the web, and loads the scripts of the Office host.
"""

from __future__ import annotations

#: Where Office on the web comes from, and with it the frame around the add-in.
_OFFICE = " ".join(
    f"https://*.{domain}"
    for domain in ("office.com", "officeapps.live.com", "office365.com", "microsoft365.com",
                   "cloud.microsoft", "sharepoint.com", "live.com")
)  # fmt: skip
#: Where the script of the Office host comes from, with what it loads itself.
_OFFICE_JS = (
    "https://appsforoffice.microsoft.com https://ajax.aspnetcdn.com https://ajax.microsoft.com"
)
_OWN = "script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'"
_ALWAYS = "base-uri 'none'; form-action 'self'"

#: Of anything that is no page.
NO_PAGE = "default-src 'none'; frame-ancestors 'none'"
#: Of the page for the browser.
PAGE = f"default-src 'none'; {_OWN}; {_ALWAYS}; frame-ancestors 'none'"
#: Of the page of the add-in. What Office itself loads beside its script is known to Office alone: pictures, frames and
#: connections may be of any HTTPS address, scripts may not.
ADD_IN_PAGE = (
    f"default-src 'none'; script-src 'self' {_OFFICE_JS}; style-src 'self' 'unsafe-inline'; "
    f"img-src 'self' data: blob: https:; font-src https:; connect-src 'self' https: wss:; frame-src https:; "
    f"{_ALWAYS}; frame-ancestors 'self' {_OFFICE}"
)


def headers_with(policy: str = NO_PAGE) -> dict[str, str]:
    """The headers of an answer."""
    return {
        "Cache-Control": "no-cache",
        "X-Content-Type-Options": "nosniff",
        "Referrer-Policy": "no-referrer",
        "Content-Security-Policy": policy,
    }
