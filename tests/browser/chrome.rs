//! A browser without a window, spoken to in its DevTools protocol over a pair of pipes.

use std::io::{BufRead, BufReader, Write};
use std::os::unix::process::CommandExt;
use std::path::Path;
use std::process::{Child, ChildStdin, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use serde_json::{Value, json};

/// A browser that does not answer for so long hangs.
const PATIENCE: Duration = Duration::from_secs(60);

/// The names a Chromium goes by.
const NAMES: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

pub struct Chrome {
    child: Child,
    input: ChildStdin,
    messages: Receiver<Value>,
    profile: tempfile::TempDir,
    asked: u64,
}

/// A page that is open, with what was heard of it.
pub struct Tab<'a> {
    chrome: &'a mut Chrome,
    session: String,
    events: Vec<Value>,
}

impl Chrome {
    /// `None` where there is none, and that is accepted.
    pub fn start() -> Option<Self> {
        let places = std::env::var_os("PATH").unwrap_or_default();
        let found = NAMES.iter().flat_map(|name| std::env::split_paths(&places).map(move |place| place.join(name)));
        let Some(program) = found.into_iter().find(|path| path.is_file()) else {
            let accepted = std::env::var("PAIRWAVE_ALLOW_NO_BROWSER").is_ok_and(|v| v == "1");
            assert!(
                accepted,
                "these tests need Chromium (Debian: apt-get install chromium), or PAIRWAVE_ALLOW_NO_BROWSER=1 to skip them"
            );
            eprintln!("SKIPPED, there is no Chromium and PAIRWAVE_ALLOW_NO_BROWSER=1");
            return None;
        };
        let profile = tempfile::tempdir().unwrap();
        // It reads from 3 and writes to 4.
        let mut child = Command::new("sh")
            .args(["-c", r#"exec "$0" "$@" 3<&0 4>&1 </dev/null >/dev/null 2>&1"#])
            .arg(program)
            .args(["--headless=new", "--no-sandbox", "--disable-gpu", "--remote-debugging-pipe", "--no-first-run"])
            .args(["--disable-dev-shm-usage", "--disable-extensions", "--disable-background-networking"])
            .arg(format!("--user-data-dir={}", profile.path().display()))
            .arg("about:blank")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .process_group(0)
            .spawn()
            .unwrap();
        let (input, output) = (child.stdin.take().unwrap(), child.stdout.take().unwrap());
        let (sender, messages) = channel();
        std::thread::spawn(move || {
            for message in BufReader::new(output).split(0).map_while(Result::ok) {
                if sender.send(serde_json::from_slice(&message).unwrap()).is_err() {
                    break;
                }
            }
        });
        Some(Self { child, input, messages, profile, asked: 0 })
    }

    fn ask(&mut self, session: Option<&str>, method: &str, parameters: Value, events: &mut Vec<Value>) -> Value {
        self.asked += 1;
        let mut message = json!({ "id": self.asked, "method": method, "params": parameters });
        if let Some(session) = session {
            message["sessionId"] = session.into();
        }
        self.input.write_all(format!("{message}\0").as_bytes()).unwrap();
        loop {
            let answer = self.messages.recv_timeout(PATIENCE).unwrap_or_else(|e| panic!("{method}: {e}"));
            if answer["id"] == self.asked {
                assert!(answer["error"].is_null(), "{method}: {}", answer["error"]);
                return answer["result"].clone();
            }
            events.push(answer);
        }
    }

    /// Opens a file and waits until it is loaded.
    pub fn open(&mut self, file: &Path) -> Tab<'_> {
        let mut events = Vec::new();
        let target = self.ask(None, "Target.createTarget", json!({ "url": "about:blank" }), &mut events);
        let attach = json!({ "targetId": target["targetId"], "flatten": true });
        let session = self.ask(None, "Target.attachToTarget", attach, &mut events);
        let session = session["sessionId"].as_str().unwrap().to_string();
        let mut tab = Tab { chrome: self, session, events: Vec::new() };
        for domain in ["Runtime", "Log", "Network", "Page"] {
            tab.ask(&format!("{domain}.enable"), json!({}));
        }
        tab.size(1000, 800);
        tab.ask("Page.navigate", json!({ "url": url(file) }));
        tab.wait("document.readyState === 'complete' && location.protocol === 'file:'");
        tab
    }

    /// A directory for what is saved.
    pub fn downloads(&mut self) -> std::path::PathBuf {
        let dir = self.profile.path().join("saved");
        let behavior = json!({ "behavior": "allow", "downloadPath": dir });
        self.ask(None, "Browser.setDownloadBehavior", behavior, &mut Vec::new());
        let permissions = json!({ "permissions": ["clipboardReadWrite", "clipboardSanitizedWrite"] });
        self.ask(None, "Browser.grantPermissions", permissions, &mut Vec::new());
        dir
    }
}

impl Drop for Chrome {
    fn drop(&mut self) {
        let _ = self.input.write_all(b"{\"id\":0,\"method\":\"Browser.close\"}\0");
        let _ = self.child.wait();
    }
}

pub fn url(file: &Path) -> String {
    format!("file://{}", file.display())
}

impl Tab<'_> {
    pub fn ask(&mut self, method: &str, parameters: Value) -> Value {
        self.chrome.ask(Some(&self.session), method, parameters, &mut self.events)
    }

    /// The value of an expression, awaited.
    pub fn js(&mut self, expression: &str) -> Value {
        let asked =
            json!({ "expression": expression, "returnByValue": true, "awaitPromise": true, "userGesture": true });
        let answer = self.ask("Runtime.evaluate", asked);
        assert!(answer["exceptionDetails"].is_null(), "{expression:.300}: {}", answer["exceptionDetails"]);
        answer["result"]["value"].clone()
    }

    pub fn text(&mut self, expression: &str) -> String {
        let value = self.js(expression);
        value.as_str().unwrap_or_else(|| panic!("{expression}: {value}")).to_string()
    }

    pub fn wait(&mut self, condition: &str) {
        for _ in 0..600 {
            if self.js(condition) == true {
                return;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        panic!("never: {condition}");
    }

    pub fn size(&mut self, width: u32, height: u32) {
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.ask("Emulation.setDeviceMetricsOverride", size);
        // The page hears of it before the next frame.
        self.js("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))");
    }

    /// Moves the pointer to a place in px of the window.
    pub fn point(&mut self, [x, y]: [f64; 2]) {
        self.ask("Input.dispatchMouseEvent", json!({ "type": "mouseMoved", "x": x, "y": y }));
    }

    pub fn touch(&mut self, [x, y]: [f64; 2]) {
        let at = json!([{ "x": x, "y": y }]);
        self.ask("Input.dispatchTouchEvent", json!({ "type": "touchStart", "touchPoints": at }));
        self.ask("Input.dispatchTouchEvent", json!({ "type": "touchEnd", "touchPoints": [] }));
    }

    pub fn key(&mut self, key: &str) {
        for kind in ["keyDown", "keyUp"] {
            self.ask("Input.dispatchKeyEvent", json!({ "type": kind, "key": key, "code": key }));
        }
    }

    /// Clicks on the first element of a selector, as a person does.
    pub fn click(&mut self, selector: &str) {
        let place = format!(
            "(() => {{ const e = document.querySelector({}); e.scrollIntoView({{ block: 'center' }}); const r = e.getBoundingClientRect();
               return [r.x + r.width / 2, r.y + r.height / 2]; }})()",
            json!(selector)
        );
        let place = self.js(&place);
        for kind in ["mousePressed", "mouseReleased"] {
            let event = json!({ "type": kind, "x": place[0], "y": place[1], "button": "left", "clickCount": 1 });
            self.ask("Input.dispatchMouseEvent", event);
        }
    }

    /// Everything that a page should not do: messages of warnings and errors, and requests of anything but itself and what it holds.
    pub fn faults(&mut self, file: &Path) -> Vec<String> {
        // What is on its way comes before the answer.
        self.js("new Promise(done => setTimeout(done, 20))");
        let own = url(file);
        let fault = |event: &Value| {
            let p = &event["params"];
            match event["method"].as_str()? {
                "Log.entryAdded" if ["warning", "error"].contains(&p["entry"]["level"].as_str()?) => {
                    Some(format!("{}", p["entry"]["text"]))
                }
                "Runtime.consoleAPICalled" if ["warning", "error", "assert"].contains(&p["type"].as_str()?) => {
                    Some(format!("{}", p["args"]))
                }
                "Runtime.exceptionThrown" => Some(format!("{}", p["exceptionDetails"])),
                "Network.requestWillBeSent" => {
                    let to = p["request"]["url"].as_str()?;
                    let held = to == own || to.starts_with("data:") || to.starts_with("blob:");
                    (!held).then(|| format!("request of {to}"))
                }
                _ => None,
            }
        };
        self.events.iter().filter_map(fault).collect()
    }

    /// What axe-core finds against accessibility, of all rules or some.
    pub fn violations(&mut self, rules: &str) -> Vec<String> {
        if self.js("typeof axe") == "undefined" {
            self.js(include_str!("axe/axe.min.js"));
        }
        let found = self.js(&format!(
            "axe.run(document, {{ {rules}resultTypes: ['violations'] }}).then(found => found.violations.flatMap(v =>
               v.nodes.map(n => `${{v.id}}: ${{n.target}} ${{n.failureSummary}}`)))"
        ));
        found.as_array().unwrap().iter().map(|v| v.as_str().unwrap().to_string()).collect()
    }

    pub fn pdf(&mut self) -> Vec<u8> {
        use base64::Engine as _;
        let printed = self.ask("Page.printToPDF", json!({ "preferCSSPageSize": true, "printBackground": false }));
        base64::engine::general_purpose::STANDARD.decode(printed["data"].as_str().unwrap()).unwrap()
    }

    pub fn close(mut self) {
        self.ask("Page.close", json!({}));
    }
}
