//! A real browser, driven by its DevTools protocol.

use std::io::{BufRead, BufReader, ErrorKind};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use base64::Engine;
use image::RgbaImage;
use serde_json::{Value, json};
use tempfile::TempDir;
use tungstenite::{Error, Message, WebSocket};

/// Timeout of the browser, generous enough for a slow machine.
const PATIENCE: Duration = Duration::from_secs(1800);

/// A browser with one page.
pub struct Chromium {
    process: Child,
    socket: WebSocket<TcpStream>,
    session: Option<String>,
    n_sent: u64,
    /// Events that the browser has sent.
    events: Vec<Value>,
    _profile: TempDir,
}

impl Chromium {
    /// Starts a browser with a window of this size and opens a page, which sets
    /// `data-ready` when it is complete.
    pub fn open(page: &Path, size: [u32; 2]) -> Self {
        let mut browser = Self::start(size);
        browser.visit(page, "document.body && 'ready' in document.body.dataset");
        browser
    }

    /// Starts a browser with an empty window of this size.
    pub fn start([width, height]: [u32; 2]) -> Self {
        let mut browser = Self::launch();
        let target = browser.send("Target.createTarget", json!({ "url": "about:blank" }));
        let session = browser.send(
            "Target.attachToTarget",
            json!({ "targetId": target["targetId"], "flatten": true }),
        );
        browser.session = Some(session["sessionId"].as_str().unwrap().to_owned());
        for domain in ["Page", "Runtime", "Log", "Network"] {
            browser.send(&format!("{domain}.enable"), json!({}));
        }
        browser.resize(width, height);
        browser
    }

    /// Opens a page, and waits until a condition holds.
    pub fn visit(&mut self, page: &Path, ready: &str) {
        let url = format!("file://{}", std::path::absolute(page).unwrap().display());
        self.send("Page.navigate", json!({ "url": url }));
        self.wait_until(ready);
    }

    fn launch() -> Self {
        let program = std::env::var("RAYCOST_CHROMIUM").expect("run tests/with-chromium");
        let profile = tempfile::tempdir().unwrap();
        let mut process = Command::new(program)
            .args(["--headless", "--no-sandbox", "--use-angle=swiftshader"])
            .args(["--enable-unsafe-swiftshader", "--hide-scrollbars"])
            .args([
                "--disable-background-networking",
                "--disable-component-update",
            ])
            .args([
                "--disable-sync",
                "--no-first-run",
                "--remote-debugging-port=0",
            ])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .stdin(Stdio::null())
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let mut lines = BufReader::new(process.stderr.take().unwrap()).lines();
        let url = lines
            .find_map(|line| {
                Some(
                    line.unwrap()
                        .strip_prefix("DevTools listening on ")?
                        .to_owned(),
                )
            })
            .expect("Chromium does not listen");
        // Drain further output, so that the browser does not block.
        std::thread::spawn(move || lines.for_each(drop));
        let address = url
            .strip_prefix("ws://")
            .unwrap()
            .split('/')
            .next()
            .unwrap();
        let stream = TcpStream::connect(address).unwrap();
        stream.set_read_timeout(Some(PATIENCE)).unwrap();
        let (socket, _) = tungstenite::client(&url, stream).unwrap();
        Self {
            process,
            socket,
            session: None,
            n_sent: 0,
            events: Vec::new(),
            _profile: profile,
        }
    }

    /// Sends a command and returns its result.
    pub fn send(&mut self, method: &str, parameters: Value) -> Value {
        self.n_sent += 1;
        let id = self.n_sent;
        let mut message = json!({ "id": id, "method": method, "params": parameters });
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        self.socket
            .send(Message::text(message.to_string()))
            .unwrap();
        loop {
            let text = match self.socket.read() {
                Ok(Message::Text(text)) => text,
                Ok(_) => continue,
                Err(Error::Io(error)) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => panic!("{method}: {error}"),
            };
            let mut reply: Value = serde_json::from_str(&text).unwrap();
            if reply["id"] == json!(id) {
                assert!(reply["error"].is_null(), "{method}: {reply}");
                return reply["result"].take();
            }
            self.events.push(reply);
        }
    }

    /// Returns the value of a JavaScript expression; awaits a promise.
    pub fn value(&mut self, expression: &str) -> Value {
        let parameters = json!({
            "expression": expression,
            "awaitPromise": true,
            "returnByValue": true,
        });
        let mut result = self.send("Runtime.evaluate", parameters);
        assert!(
            result["exceptionDetails"].is_null(),
            "{expression}: {result}"
        );
        result["result"]["value"].take()
    }

    /// The text of an element.
    pub fn text(&mut self, selector: &str) -> String {
        let text = self.value(&format!("document.querySelector({selector:?}).textContent"));
        text.as_str().unwrap().to_owned()
    }

    /// Waits for a condition; fails with the page's error message.
    pub fn wait_until(&mut self, condition: &str) {
        let begin = Instant::now();
        while self.value(condition) != json!(true) {
            let failure = "document.querySelector('#failure:not([hidden])')?.textContent";
            let failure = self.value(failure);
            assert!(failure.is_null(), "{failure}");
            assert!(begin.elapsed() < PATIENCE, "never: {condition}");
            std::thread::sleep(Duration::from_millis(20));
        }
        // The change is drawn in one of the next two frames.
        let two_frames = "new Promise((done) =>
            requestAnimationFrame(() => requestAnimationFrame(() => done(0))))";
        self.value(two_frames);
    }

    /// Sets the size of the window.
    pub fn resize(&mut self, width: u32, height: u32) {
        let size = json!({
            "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false,
        });
        self.send("Emulation.setDeviceMetricsOverride", size);
    }

    /// Sets the preferred color scheme, `light` or `dark`.
    pub fn prefer(&mut self, scheme: &str) {
        let feature = json!({ "name": "prefers-color-scheme", "value": scheme });
        self.send(
            "Emulation.setEmulatedMedia",
            json!({ "features": [feature] }),
        );
    }

    /// Presses a key, optionally with Shift.
    pub fn press(&mut self, key: &str, shift: bool) {
        let key_code = match key {
            "Tab" => 9,
            "ArrowLeft" => 37,
            "ArrowUp" => 38,
            "ArrowRight" => 39,
            "ArrowDown" => 40,
            _ => 0,
        };
        for kind in ["rawKeyDown", "keyUp"] {
            let event = json!({
                "type": kind, "key": key, "code": key, "windowsVirtualKeyCode": key_code,
                "modifiers": if shift { 8 } else { 0 },
            });
            self.send("Input.dispatchKeyEvent", event);
        }
    }

    /// Sends a mouse event, `mouseMoved`, `mousePressed` or `mouseReleased`, at a
    /// position in the window.
    pub fn point(&mut self, kind: &str, x: f64, y: f64) {
        let pressed = if kind == "mouseMoved" { "none" } else { "left" };
        let event = json!({ "type": kind, "x": x, "y": y, "button": pressed, "clickCount": 1 });
        self.send("Input.dispatchMouseEvent", event);
    }

    /// Drags from one position in the window to another.
    pub fn drag(&mut self, from: [f64; 2], to: [f64; 2]) {
        self.point("mousePressed", from[0], from[1]);
        for step in 1..=4 {
            let t = f64::from(step) / 4.0;
            let [x, y] = [0, 1].map(|i| from[i] + t * (to[i] - from[i]));
            let event = json!({
                "type": "mouseMoved", "x": x, "y": y, "button": "left", "buttons": 1,
            });
            self.send("Input.dispatchMouseEvent", event);
        }
        self.point("mouseReleased", to[0], to[1]);
    }

    /// Left, top, width and height of an element, which is scrolled into view.
    pub fn place(&mut self, selector: &str) -> [f64; 4] {
        let place = self.value(&format!(
            "(() => {{
                const element = document.querySelector({selector:?});
                element.scrollIntoView({{ block: 'center' }});
                const {{ left, top, width, height }} = element.getBoundingClientRect();
                return [left, top, width, height];
            }})()"
        ));
        serde_json::from_value(place).unwrap()
    }

    /// Takes a screenshot, which is also written to `target/chromium/`.
    pub fn screenshot(&mut self, name: &str, whole_page: bool) -> RgbaImage {
        let parameters = json!({ "format": "png", "captureBeyondViewport": whole_page });
        let shot = self.send("Page.captureScreenshot", parameters);
        let png = base64::engine::general_purpose::STANDARD
            .decode(shot["data"].as_str().unwrap())
            .unwrap();
        let folder = super::in_repository("target/chromium");
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join(format!("{name}.png")), &png).unwrap();
        image::load_from_memory(&png).unwrap().into_rgba8()
    }

    /// Fails if the page logged a warning or requested any other resource.
    pub fn assert_calm(&mut self) {
        self.value("0"); // wait for earlier events
        for event in &self.events {
            let parameters = &event["params"];
            match event["method"].as_str().unwrap_or_default() {
                "Runtime.exceptionThrown" => panic!("{parameters}"),
                "Runtime.consoleAPICalled" | "Log.entryAdded" => {
                    let level = parameters["type"].as_str();
                    let level = level.or(parameters["entry"]["level"].as_str());
                    // Without a GPU Chromium warns about slow rendering.
                    let is_fine = parameters.to_string().contains("GPU stall")
                        || !matches!(level, Some("error" | "warning" | "assert"));
                    assert!(is_fine, "{parameters}");
                }
                "Network.requestWillBeSent" => {
                    let url = parameters["request"]["url"].as_str().unwrap();
                    let is_local = url.starts_with("file://") || url.starts_with("data:");
                    assert!(is_local, "requests {url}");
                }
                _ => {}
            }
        }
    }
}

impl Drop for Chromium {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
